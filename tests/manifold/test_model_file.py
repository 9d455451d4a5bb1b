"""Model files: what was saved is loaded; a damaged file is loaded, all finite, or refused."""

import io
import json
import tracemalloc
import zipfile

import numpy as np
import pytest

from numpy_cae.manifold import ModelFileError, load_manifold, save_manifold, starter
from numpy_cae.motion import angles_of, cut_clips

KINDS = pytest.mark.parametrize("kind", ["conv", "sequence"])


@pytest.fixture(scope="module")
def models(tiny_manifolds, tmp_path_factory):
    """The bytes of a saved model of each kind."""
    file = tmp_path_factory.mktemp("models") / "m.npz"
    saved = {}
    for kind, manifold in tiny_manifolds[0].items():
        save_manifold(manifold, file)
        assert [each.name for each in file.parent.iterdir()] == ["m.npz"]
        saved[kind] = file.read_bytes()
    return saved


@pytest.mark.parametrize("engine", ["fast", "ops"])
@KINDS
def test_a_manifold_comes_back(tiny_manifolds, models, tmp_path, kind, engine):
    (tmp_path / "m.npz").write_bytes(models[kind])
    saved, loaded = tiny_manifolds[0][kind], load_manifold(tmp_path / "m.npz", engine)
    assert loaded.settings == json.loads(json.dumps(saved.settings))
    if kind == "conv":
        assert (loaded.rate, loaded.rescales, loaded.window) == (30.0, True, 16)
        features = saved.body(tiny_manifolds[1]).features
        found, expected = (each.project(features) for each in (loaded, saved))
    else:
        assert (loaded.rate, loaded.frames, loaded.table) == (25.0, 30, saved.table)
        np.testing.assert_array_equal(loaded.offsets, saved.offsets)
        x = saved.normalise(cut_clips([angles_of(tiny_manifolds[1])]))
        found, expected = (each.network.denoise(x) for each in (loaded, saved))
    np.testing.assert_allclose(found, expected, atol=0 if engine == "fast" else 1e-5)
    with pytest.raises(ValueError, match="engine is 'slow'"):
        load_manifold(tmp_path / "m.npz", "slow")


def arrays_of(data: bytes) -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(data)) as file:
        return {name: file[name] for name in file.files}


def packed(arrays: dict[str, np.ndarray]) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def load_or_refuse(data: bytes, path, what) -> bool:
    """Load a file in bounded memory: a model of finite weights, or a message of one line."""
    path.write_bytes(data)
    tracemalloc.start()
    try:
        model = load_manifold(path, "ops")
    except ModelFileError as error:
        model = None
        assert str(error).startswith(f"{path}: ") and "\n" not in str(error), what
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 200 * len(data) + 5e6, (what, peak)
    if model is not None:
        weights = getattr(model.network, "weights", None)
        arrays = weights.values() if weights else [each.w for each in model.network.layers]
        assert all(np.isfinite(array).all() for array in arrays), what
    return model is not None


@pytest.mark.parametrize("count", [40, pytest.param(2000, marks=pytest.mark.thorough)])
@KINDS
def test_damaged_bytes(models, kind, tmp_path, count, counted):
    """A few bits flipped; in some files a part is missing or replaced as well."""
    data, path, loaded = models[kind], tmp_path / "m.npz", 0
    assert load_or_refuse(data, path, "whole")
    for number in range(count):
        rng = np.random.default_rng([count, number])
        changed = bytearray(data)
        for place in rng.integers(0, len(data), rng.integers(1, 6)):
            changed[place] ^= 1 << int(rng.integers(8))
        if rng.random() < 0.4:
            at, length = rng.integers(len(data)), rng.integers(1, 400)
            changed[at : at + length] = rng.bytes(int(rng.integers(0, 400)))
        loaded += load_or_refuse(bytes(changed), path, (kind, number))
        assert not load_or_refuse(data[: rng.integers(len(data))], path, (kind, number, "cut"))
    assert loaded < count
    if count > 1000:
        counted(f"{count} models ({kind}) with flipped, lost or replaced bytes: {loaded} loaded")


REPLACEMENTS = [np.array(np.nan), np.array([]), np.array(-1.0), np.array(1j), np.array([True])]
REPLACEMENTS += [np.array("text"), np.array("{}"), np.array("[" * 100_000)]
REPLACEMENTS += [np.zeros(n, np.float32) for n in ((0, 0, 0), (200_000,), (1, 1000, 1000))]


@KINDS
def test_every_array_missing_replaced_or_not_finite(models, kind, tmp_path):
    arrays, path = arrays_of(models[kind]), tmp_path / "m.npz"
    for number, (name, array) in enumerate(arrays.items()):
        without = {key: value for key, value in arrays.items() if key != name}
        assert not load_or_refuse(packed(without), path, (name, "missing"))
        new = REPLACEMENTS[number % len(REPLACEMENTS)]
        load_or_refuse(packed(arrays | {name: new}), path, (name, new.shape, new.dtype))
        if array.dtype.kind == "f":
            bad = array.copy()
            bad.flat[-1] = np.nan
            path.write_bytes(packed(arrays | {name: bad}))
            with pytest.raises(ModelFileError, match=f"{name} holds"):
                load_manifold(path)


def with_a_large_header(data: bytes) -> bytes:
    """The file with an array that claims to have a billion numbers."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(buffer, "w") as new:
        for info in old.infolist():
            body = old.read(info)
            if info.filename == "mean_pose.npy":
                body = body.replace(b"(63,), }" + b" " * 10, b"(1000000063,), }  ", 1)
                assert b"1000000063" in body
            new.writestr(info.filename, body)
    return buffer.getvalue()


def expanding(data: bytes) -> bytes:
    """The file with a text of 20 MB as its format, in 20 kB."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays_of(data) | {"format": np.array("x" * 5_000_000)})
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("kind", "change", "message"),
    [
        ("conv", {"format": np.array("another")}, "its format is 'another', expected"),
        ("conv", {"format": np.array("numpy_cae convolutional manifold 2")}, "make the file again"),
        ("conv", {"rate": np.array([{"run": "me"}], dtype=object)}, "not a model"),
        ("conv", {"w1": np.zeros((5, 62, 12), np.float32)}, "w1 has shape"),
        ("conv", {"joints": np.array(["tail"])}, "joints"),
        ("conv", {"rescales": np.array(True)}, "rescales is not"),
        ("conv", {"settings": np.array('{"a": ' + "[" * 50_000 + "]" * 50_000 + "}")}, "recursion"),
        ("conv", {"window": np.array(-3)}, "window is not a whole number"),
        ("conv", expanding, "unpacks to 20 MB, expected at most 4 MB"),
        ("conv", with_a_large_header, "size of an array differs"),
        ("sequence", {"mean": np.zeros(53)}, "mean has shape"),
        ("sequence", {"deviation": np.zeros(54)}, "not from 1e-06"),
        ("sequence", {"table": np.array("another")}, "not one of this version"),
        ("sequence", {"state_w": np.zeros(3)}, "not a matrix"),
        ("sequence", {"state_w": np.zeros((0, 10**6))}, "weights are smaller"),
        ("sequence", {"frames": np.array(10**9)}, "frames is not a whole number"),
    ],
)
def test_what_is_wrong_is_named(models, tmp_path, kind, change, message):
    data, path = models[kind], tmp_path / "m.npz"
    data = change(data) if callable(change) else packed(arrays_of(data) | change)
    assert not load_or_refuse(data, path, message)
    with pytest.raises(ModelFileError, match=message):
        load_manifold(path)
    with pytest.raises(ModelFileError, match="No such file"):
        load_manifold(tmp_path / "missing.npz")


def test_half_precision_is_a_smaller_file_of_nearly_the_same_model(untrained_manifold, tmp_path):
    for half in (False, True):
        save_manifold(untrained_manifold, tmp_path / f"{half}.npz", half=half)
    smaller, larger = ((tmp_path / f"{half}.npz").stat().st_size for half in (True, False))
    assert smaller < 0.7 * larger
    x = np.random.default_rng(0).normal(size=(40, 63))
    loaded = load_manifold(tmp_path / "True.npz")
    assert loaded.network.layers[0].w.dtype == np.float32
    np.testing.assert_allclose(loaded.project(x), untrained_manifold.project(x), atol=0.02)


def test_the_starter_model_says_what_it_learned_from():
    manifold = starter()
    assert [folder["name"] for folder in manifold.settings["folders"]] == ["asfamc", "motions"]
    assert manifold.rate == 30.0
