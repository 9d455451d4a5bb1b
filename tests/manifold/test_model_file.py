"""Model files: what was saved is loaded; a damaged file is loaded, all finite, or refused."""

import io
import json

import numpy as np
import pytest

from numpy_cae.manifold import ModelFileError, load_manifold
from numpy_cae.mocap import angles_of
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion import cut_clips

TYPES = pytest.mark.parametrize("kind", ["conv", "sequence"])


@pytest.fixture(scope="module")
def models(tiny_manifolds, tmp_path_factory):
    """The bytes of a saved model of each kind."""
    file = tmp_path_factory.mktemp("models") / "m.npz"
    saved = {}
    for kind, manifold in tiny_manifolds[0].items():
        manifold.save(file)
        assert [path.name for path in file.parent.iterdir()] == ["m.npz"]
        saved[kind] = file.read_bytes()
    return saved


@pytest.fixture
def file(tmp_path):
    return tmp_path / "m.npz"


@pytest.mark.parametrize("engine", ["fast", "ops"])
@TYPES
def test_a_manifold_comes_back(tiny_manifolds, models, file, kind, engine):
    file.write_bytes(models[kind])
    saved = tiny_manifolds[0][kind]
    loaded = load_manifold(file, engine)
    assert loaded.settings == json.loads(json.dumps(saved.settings))
    if kind == "conv":
        assert (loaded.rate, loaded.rescales, loaded.window) == (30.0, True, 16)
        features = Body(tiny_manifolds[1], saved.lengths).features
        results = [manifold.project(features) for manifold in (loaded, saved)]
    else:
        assert (loaded.rate, loaded.frames, loaded.table) == (25.0, 30, saved.table)
        np.testing.assert_array_equal(loaded.offsets, saved.offsets)
        x = saved.normalise(cut_clips([angles_of(tiny_manifolds[1])]))
        results = [manifold.network.denoise(x) for manifold in (loaded, saved)]
    np.testing.assert_allclose(*results, atol=0 if engine == "fast" else 1e-5)
    with pytest.raises(ValueError, match="engine is 'slow'"):
        load_manifold(file, "slow")


def arrays_of(data: bytes) -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(data)) as file:
        return dict(file)


def is_loaded(data: bytes, path) -> bool:
    """Whether the bytes are a model, of finite weights; otherwise they are refused in one line."""
    path.write_bytes(data)
    try:
        network = load_manifold(path, "ops").network
    except ModelFileError as error:
        assert str(error).startswith(f"{path}: ") and "\n" not in str(error)
        return False
    weights = network.weights if hasattr(network, "weights") else network.parameters
    assert all(np.isfinite(array).all() for array in weights.values())
    return True


@pytest.mark.parametrize("count", [40, pytest.param(2000, marks=pytest.mark.thorough)])
@TYPES
def test_damaged_bytes(models, kind, file, count, counted):
    """A few bits flipped; in some files a part is missing or replaced as well."""
    data, loaded = models[kind], 0
    assert is_loaded(data, file)
    for number in range(count):
        rng = np.random.default_rng([count, number])
        changed = bytearray(data)
        for place in rng.integers(0, len(data), rng.integers(1, 6)):
            changed[place] ^= 1 << int(rng.integers(8))
        if rng.random() < 0.4:
            at, length = rng.integers(len(data)), rng.integers(1, 400)
            changed[at : at + length] = rng.bytes(int(rng.integers(0, 400)))
        loaded += is_loaded(bytes(changed), file)
        assert not is_loaded(data[: rng.integers(len(data))], file)
    assert loaded < count
    if count > 1000:
        counted(f"{count} models ({kind}) with flipped, lost or replaced bytes: {loaded} loaded")


@TYPES
def test_an_array_that_is_missing_or_not_finite_is_an_error(models, kind, file):
    arrays = arrays_of(models[kind])
    for name, array in arrays.items():
        np.savez(file, **{key: value for key, value in arrays.items() if key != name})
        assert not is_loaded(file.read_bytes(), file)
        if array.dtype.kind == "f":
            bad = array.copy()
            bad.flat[-1] = np.nan
            np.savez(file, **arrays | {name: bad})
            with pytest.raises(ModelFileError, match=f"{name} holds"):
                load_manifold(file)


@pytest.mark.parametrize(
    ("kind", "name", "array", "message"),
    [
        ("conv", "format", "numpy_cae convolutional manifold 2", "manifold 2', expected .* again"),
        ("conv", "format", "x" * 5_000_000, "unpacks to 20 MB, expected at most 5 MB"),
        ("conv", "rate", np.array([{"run": "me"}], dtype=object), "not a model"),
        ("conv", "w1", np.zeros((5, 62, 12), np.float32), "w1 has shape"),
        ("conv", "joints", ["tail"], "joints"),
        ("conv", "lengths", np.zeros(20), "lengths: the bones to both knees"),
        ("conv", "rescales", True, "rescales is not"),
        ("conv", "settings", '{"a": ' + "[" * 50_000 + "]" * 50_000 + "}", "recursion"),
        ("conv", "settings", 3.0, "settings is not a JSON object"),
        ("conv", "context_axes", np.zeros((3, 944)), "context_axes has shape"),
        ("conv", "context_axes", 1.0, "context_axes has shape"),
        ("conv", "context_axes", np.full((2, 945), 100.0), "context_noise is too small"),
        ("conv", "context_noise", 0.0, "context_noise holds"),
        ("conv", "window", -3, "window is not a whole number"),
        ("sequence", "mean", np.zeros(53), "mean has shape"),
        ("sequence", "deviation", np.zeros(54), "not from 1e-06"),
        ("sequence", "table", "another", "not one of this version"),
        ("sequence", "state_w", np.zeros(3), "unpack"),
        ("sequence", "state_w", np.zeros((0, 10**6)), "encoder_w has shape"),
        ("sequence", "frames", 10**9, "frames is not a whole number"),
    ],
)
def test_what_is_wrong_is_named(models, file, kind, name, array, message):
    np.savez_compressed(file, **arrays_of(models[kind]) | {name: np.array(array)})
    with pytest.raises(ModelFileError, match=message) as refused:
        load_manifold(file)
    assert "\n" not in str(refused.value)
    with pytest.raises(ModelFileError, match="No such file"):
        load_manifold(file.with_name("missing.npz"))


def test_half_precision_is_a_smaller_file_of_nearly_the_same_model(untrained_manifold, tmp_path):
    for half in (False, True):
        untrained_manifold.save(tmp_path / f"{half}.npz", half=half)
    smaller, larger = ((tmp_path / f"{half}.npz").stat().st_size for half in (True, False))
    assert smaller < 0.7 * larger
    x = np.random.default_rng(0).normal(size=(40, 63))
    loaded = load_manifold(tmp_path / "True.npz")
    assert loaded.network.layers[0].w.dtype == np.float32
    np.testing.assert_allclose(loaded.project(x), untrained_manifold.project(x), atol=0.02)


def test_a_file_without_principal_components_is_read(models, file):
    arrays = arrays_of(models["conv"])
    np.savez(file, **{key: value for key, value in arrays.items() if "context" not in key})
    assert load_manifold(file).context is None
    file.write_bytes(models["conv"])
    assert load_manifold(file).context is not None
