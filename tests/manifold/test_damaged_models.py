"""Whatever happened to a model file: it loads, all finite, or is refused as a ModelFileError."""

from __future__ import annotations

import io
import json
import tracemalloc
import zipfile

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.manifold import (
    ModelFileError,
    learn_manifold,
    learn_sequences,
    load_manifold,
    load_sequences,
    save_manifold,
    save_sequences,
)
from numpy_cae.motion import angles_of, body_of
from numpy_cae.training import Schedule, SequenceSchedule, Stage


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """A saved model of each kind, and what loads it."""
    folder = tmp_path_factory.mktemp("models")
    motion = make_take("walk", 0, seconds=2.0, rate=50.0).motion
    stage = Stage(epochs=1)
    manifold = learn_manifold(
        [body_of(motion)], Schedule(stage, stage), 0, 16, 8, (4, 6), 5, show_progress=False
    )
    save_manifold(manifold, folder / "conv.npz")
    short = SequenceSchedule(epochs=1, steps=2, batch=4, directions=4)
    sequences = learn_sequences([angles_of(motion)], short, hidden=6, latent=3, show_progress=False)
    save_sequences(sequences, folder / "sequence.npz")
    return {
        "conv": ((folder / "conv.npz").read_bytes(), load_manifold),
        "sequence": ((folder / "sequence.npz").read_bytes(), load_sequences),
    }


def arrays_of(data: bytes) -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(data)) as file:
        return {name: file[name] for name in file.files}


def packed(arrays: dict[str, np.ndarray]) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def load_or_refuse(load, data: bytes, path, what) -> bool:
    path.write_bytes(data)
    tracemalloc.start()
    try:
        model = load(path)
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


def mutate_many(models, kind, tmp_path, count, seed):
    data, load = models[kind]
    loaded = 0
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        changed = bytearray(data)
        for place in rng.integers(0, len(data), rng.integers(1, 6)):
            changed[place] ^= 1 << int(rng.integers(8))
        if rng.random() < 0.3:
            changed = changed[: rng.integers(0, len(changed))]
        if rng.random() < 0.2:
            at, length = rng.integers(len(data)), rng.integers(1, 400)
            changed[at : at + length] = rng.bytes(int(rng.integers(0, 400)))
        loaded += load_or_refuse(load, bytes(changed), tmp_path / "m.npz", (kind, seed, number))
    assert loaded < count


@pytest.mark.parametrize("kind", ["conv", "sequence"])
def test_flipped_bytes(models, kind, tmp_path):
    assert load_or_refuse(models[kind][1], models[kind][0], tmp_path / "m.npz", "whole")
    mutate_many(models, kind, tmp_path, 60, seed=0)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["conv", "sequence"])
def test_many_flipped_bytes(models, kind, tmp_path):
    mutate_many(models, kind, tmp_path, 5000, seed=1)


REPLACEMENTS = [
    np.array(np.nan),
    np.array([]),
    np.zeros((0, 0, 0), np.float32),
    np.zeros(200_000, np.float32),
    np.zeros((1, 1000, 1000), np.float32),
    np.array("text"),
    np.array("[" * 100_000),
    np.array("{}"),
    np.array(-1.0),
    np.array(1j),
    np.array([True]),
]


@pytest.mark.parametrize("each", [2, pytest.param(99, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("kind", ["conv", "sequence"])
def test_every_array_missing_replaced_or_not_finite(models, kind, tmp_path, each):
    data, load = models[kind]
    arrays = arrays_of(data)
    for number, (name, array) in enumerate(arrays.items()):
        without = {key: value for key, value in arrays.items() if key != name}
        # A network of fewer layers is one too where the last layer is missing, but its b tells.
        load_or_refuse(load, packed(without), tmp_path / "m.npz", (name, "missing"))
        for new in (
            REPLACEMENTS[number % len(REPLACEMENTS) :] + REPLACEMENTS[: number % len(REPLACEMENTS)]
        )[:each]:
            what = (name, new.shape, new.dtype)
            load_or_refuse(load, packed(arrays | {name: new}), tmp_path / "m.npz", what)
        if array.dtype.kind == "f":
            bad = array.copy()
            bad.flat[-1] = np.nan
            with pytest.raises(ModelFileError, match=f"{name} holds"):
                (tmp_path / "m.npz").write_bytes(packed(arrays | {name: bad}))
                load(tmp_path / "m.npz")


@pytest.mark.parametrize("kind", ["conv", "sequence"])
def test_another_version_pickles_and_the_other_kind(models, kind, tmp_path):
    data, load = models[kind]
    arrays = arrays_of(data)
    path = tmp_path / "m.npz"
    form = str(arrays["format"]).replace("1", "2")
    path.write_bytes(packed(arrays | {"format": np.array(form)}))
    with pytest.raises(ModelFileError, match="manifold 2"):
        load(path)
    path.write_bytes(packed(arrays | {"rate": np.array([{"run": "me"}], dtype=object)}))
    with pytest.raises(ModelFileError, match="not a model"):
        load(path)
    other = models["conv" if kind == "sequence" else "sequence"][0]
    path.write_bytes(other)
    with pytest.raises(ModelFileError, match="not a 'numpy_cae"):
        load(path)


def test_a_header_that_claims_a_billion_numbers(models, tmp_path):
    data, load = models["conv"]
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(buffer, "w") as new:
        for info in old.infolist():
            body = old.read(info)
            if info.filename == "mean_pose.npy":
                body = body.replace(b"(63,), }" + b" " * 10, b"(1000000063,), }  ", 1)
                assert b"1000000063" in body
            new.writestr(info.filename, body)
    assert not load_or_refuse(load, buffer.getvalue(), tmp_path / "m.npz", "billion")


def test_settings_that_are_nested_deeply(models, tmp_path):
    data, load = models["conv"]
    deep = json.dumps({"a": 1}).replace("1", "[" * 50_000 + "]" * 50_000)
    changed = packed(arrays_of(data) | {"settings": np.array(deep)})
    assert not load_or_refuse(load, changed, tmp_path / "m.npz", "deep")
