"""Model files: what was saved is loaded; a damaged file is loaded, all finite, or refused."""

import io
import json
import tracemalloc
import zipfile

import numpy as np
import pytest

from numpy_cae.array_file import DIGEST, digest_of
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


def packed(arrays: dict[str, np.ndarray], digested: bool = True) -> bytes:
    """The arrays as a file, with the digest of what they hold now."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays | ({DIGEST: np.array(digest_of(arrays))} if digested else {}))
    return buffer.getvalue()


def load_or_refuse(data: bytes, path, what) -> bool:
    path.write_bytes(data)
    tracemalloc.start()
    try:
        model = load_manifold(path)
    except ModelFileError as refused:
        assert str(path) in str(refused), what
        assert "\n" not in str(refused), what
        model = None
    except Exception as error:
        raise AssertionError(f"{what}: {error!r}") from error
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 200 * len(data) + 5e6, (what, peak)
    if model is not None:
        weights = getattr(model.network, "weights", None)
        arrays = weights.values() if weights else [each.w for each in model.network.layers]
        assert all(np.isfinite(array).all() for array in arrays), what
    return model is not None


@pytest.mark.parametrize("count", [60, pytest.param(2000, marks=pytest.mark.thorough)])
@KINDS
def test_flipped_bytes(models, kind, tmp_path, count, counted):
    data, path = models[kind], tmp_path / "m.npz"
    assert load_or_refuse(data, path, "whole")
    loaded = 0
    for number in range(count):
        rng = np.random.default_rng([count, number])
        changed = bytearray(data)
        for place in rng.integers(0, len(data), rng.integers(1, 6)):
            changed[place] ^= 1 << int(rng.integers(8))
        if rng.random() < 0.3:
            changed = changed[: rng.integers(0, len(changed))]
        if rng.random() < 0.2:
            at, length = rng.integers(len(data)), rng.integers(1, 400)
            changed[at : at + length] = rng.bytes(int(rng.integers(0, 400)))
        loaded += load_or_refuse(bytes(changed), path, (kind, number))
    assert loaded < count
    if count > 1000:
        counted(f"{count} models ({kind}) with flipped, lost or replaced bytes: {loaded} loaded")


@pytest.mark.parametrize("step", [397, pytest.param(1, marks=pytest.mark.thorough)])
@KINDS
def test_a_model_cut_off_is_refused(models, kind, tmp_path, step, counted):
    data, path = models[kind], tmp_path / "m.npz"
    for length in range(0, len(data), step):
        assert not load_or_refuse(data[:length], path, (kind, length))
    if step == 1:
        counted(f"a model ({kind}) cut after each of {len(data)} bytes: all refused")


NUMBERS = [np.array(np.nan), np.array([]), np.array(-1.0), np.array(1j), np.array([True])]
TEXTS = [np.array("text"), np.array("{}"), np.array("[" * 100_000)]
SHAPES = [(0, 0, 0), (200_000,), (1, 1000, 1000)]
REPLACEMENTS = [*NUMBERS, *TEXTS, *(np.zeros(shape, np.float32) for shape in SHAPES)]


@pytest.mark.parametrize("each", [2, pytest.param(99, marks=pytest.mark.thorough)])
@KINDS
def test_every_array_missing_replaced_or_not_finite(models, kind, tmp_path, each):
    data = models[kind]
    arrays = arrays_of(data)
    for number, (name, array) in enumerate(arrays.items()):
        without = {key: value for key, value in arrays.items() if key != name}
        # A network of fewer layers is one too where the last layer is missing, but its b tells.
        load_or_refuse(packed(without), tmp_path / "m.npz", (name, "missing"))
        for new in (
            REPLACEMENTS[number % len(REPLACEMENTS) :] + REPLACEMENTS[: number % len(REPLACEMENTS)]
        )[:each]:
            what = (name, new.shape, new.dtype)
            load_or_refuse(packed(arrays | {name: new}), tmp_path / "m.npz", what)
        if array.dtype.kind == "f":
            bad = array.copy()
            bad.flat[-1] = np.nan
            with pytest.raises(ModelFileError, match=f"{name} holds"):
                (tmp_path / "m.npz").write_bytes(packed(arrays | {name: bad}))
                load_manifold(tmp_path / "m.npz")


@KINDS
def test_another_version_and_pickles_are_refused(models, kind, tmp_path):
    arrays, path = arrays_of(models[kind]), tmp_path / "m.npz"
    for version in ("1", "5"):
        form = str(arrays["format"])[:-1] + version
        path.write_bytes(packed(arrays | {"format": np.array(form)}))
        with pytest.raises(ModelFileError, match=f"manifold {version}'.*make the file again"):
            load_manifold(path)
    pickled = {"rate": np.array([{"run": "me"}], dtype=object)}
    path.write_bytes(packed(arrays | pickled, digested=False))
    with pytest.raises(ModelFileError, match="not a model"):
        load_manifold(path)


@pytest.mark.parametrize(
    ("kind", "changes", "message"),
    [
        ("conv", {"format": np.array("another")}, "another"),
        ("conv", {"w1": np.zeros((5, 62, 12), np.float32)}, "w1 has shape"),
        ("conv", {"joints": np.array(["tail"])}, "joints"),
        ("conv", {"rescales": np.array(True)}, "rescales is not"),
        ("conv", {"settings": np.array('{"a": ' + "[" * 50_000 + "]" * 50_000 + "}")}, "recursion"),
        ("conv", {"window": np.array(-3)}, "window is not a whole number"),
        ("sequence", {"mean": np.zeros(53)}, "mean has shape"),
        ("sequence", {"deviation": np.zeros(54)}, "not from 1e-06"),
        ("sequence", {"table": np.array("another")}, "not one of this version"),
        ("sequence", {"state_w": np.zeros(3)}, "not a matrix"),
        ("sequence", {"frames": np.array(10**9)}, "frames is not a whole number"),
    ],
)
def test_arrays_that_do_not_fit_are_named(models, tmp_path, kind, changes, message):
    path = tmp_path / "m.npz"
    path.write_bytes(packed(arrays_of(models[kind]) | changes))
    with pytest.raises(ModelFileError, match=message):
        load_manifold(path)


@KINDS
def test_edited_weights_are_refused_and_files_of_version_2_have_no_digest(models, kind, tmp_path):
    arrays, path = arrays_of(models[kind]), tmp_path / "m.npz"
    name = next(name for name, array in arrays.items() if array.dtype == np.float32)
    edited = {name: arrays[name] * np.float32(1.5)}
    path.write_bytes(packed(arrays | edited, digested=False))
    with pytest.raises(ModelFileError, match="was changed after it was written"):
        load_manifold(path)
    without = {key: array for key, array in arrays.items() if key != DIGEST}
    path.write_bytes(packed(without, digested=False))
    with pytest.raises(ModelFileError, match="has no 'digest'"):
        load_manifold(path)
    old = {"format": np.array(str(arrays["format"])[:-1] + "2")}
    path.write_bytes(packed(without | old, digested=False))
    assert type(load_manifold(path)).__name__.endswith("Manifold")


def test_sequential_files_of_version_3_have_no_burn_in(models, tmp_path):
    path = tmp_path / "m.npz"
    path.write_bytes(models["sequence"])
    assert load_manifold(path).network.burn_in > 0
    arrays = arrays_of(models["sequence"])
    del arrays["burn_in"]
    path.write_bytes(packed(arrays))
    with pytest.raises(ModelFileError, match="has no 'burn_in'"):
        load_manifold(path)
    old = {"format": np.array(str(arrays["format"])[:-1] + "3")}
    path.write_bytes(packed(arrays | old))
    assert load_manifold(path).network.burn_in == 0


def test_archives_that_expand_are_refused_before_they_are_unpacked(models, tmp_path):
    """A text of 20 MB as the format, in 20 kB."""
    path = tmp_path / "m.npz"
    np.savez_compressed(path, **arrays_of(models["conv"]) | {"format": np.array("x" * 5_000_000)})
    tracemalloc.start()
    with pytest.raises(ModelFileError, match="unpacks to 20 MB, expected at most 4 MB"):
        load_manifold(path)
    assert tracemalloc.get_traced_memory()[1] < 2e6
    tracemalloc.stop()


def test_a_header_that_claims_a_billion_numbers(models, tmp_path):
    data = models["conv"]
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(buffer, "w") as new:
        for info in old.infolist():
            body = old.read(info)
            if info.filename == "mean_pose.npy":
                body = body.replace(b"(63,), }" + b" " * 10, b"(1000000063,), }  ", 1)
                assert b"1000000063" in body
            new.writestr(info.filename, body)
    assert not load_or_refuse(buffer.getvalue(), tmp_path / "m.npz", "billion")


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
