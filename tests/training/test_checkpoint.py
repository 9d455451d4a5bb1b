"""Interrupted anywhere and resumed, training ends in the same bits; no good state is lost."""

import errno
import gc
import json
import os
import sys
import zipfile

import numpy as np
import pytest

from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import (
    Checkpoint,
    CheckpointError,
    DivergedError,
    Schedule,
    SequenceSchedule,
    Stage,
    layerwise,
    sequential,
    train_autoencoder,
    train_sequential,
)

WINDOWS = np.random.default_rng(0).normal(scale=0.3, size=(7, 8, 3)).astype(np.float32)
SCHEDULE = Schedule(Stage(epochs=2, batch=2), Stage(2, 0.01, batch=2, momentum=0.9))
ADAM = Schedule(
    Stage(epochs=1, batch=2, optimiser="adam"), Stage(2, 0.01, batch=2, optimiser="adam")
)
# Three stages of two epochs of four steps.
SHORT = SequenceSchedule(epochs=2, steps=4, batch=4, directions=4, momentum=0.9)


class Interrupted(Exception):
    """Raised in place of a step."""


def train_conv(path, resume=False, windows=WINDOWS, schedule=SCHEDULE):
    model = ConvAutoencoder(3, (4, 5), taps=3, rng=np.random.default_rng(0))
    kept = None if path is None else Checkpoint(path, 0.0, resume)
    rng = np.random.default_rng(1)
    history = train_autoencoder(model, windows, schedule, rng, False, kept)
    return [array for layer in model.layers for array in (layer.w, layer.b)], history


def train_sequence(path, resume=False):
    def draw(rng, batch):
        return rng.normal(size=(batch, 6, 3)).astype(np.float32)

    model = SequentialAutoencoder(3, 5, 2, np.random.default_rng(0))
    kept = None if path is None else Checkpoint(path, 0.0, resume)
    history = train_sequential(model, draw, SHORT, np.random.default_rng(1), False, None, kept)
    return list(model.weights.values()), history


def interrupt(monkeypatch, module, after):
    """Make the step raise instead of being made once so many have been."""
    name = "denoising_step" if module is layerwise else "sequence_step"
    step, made = getattr(module, name), [0]

    def interrupted(*arguments):
        made[0] += 1
        if made[0] > after:
            raise Interrupted
        return step(*arguments)

    monkeypatch.setattr(module, name, interrupted)


def same(one, other):
    """Whether the weights and the histories but for the times are equal to the bit."""
    (weights, history), (others, other_history) = one, other
    measured, other_measured = vars(history) | {"seconds": 0}, vars(other_history) | {"seconds": 0}
    equal = [np.array_equal(a, b) for a, b in zip(weights, others, strict=True)]
    return all(equal) and measured == other_measured


@pytest.mark.parametrize(
    ("schedule", "after"),
    [(SCHEDULE, after) for after in (0, 3, 4, 7, 8, 16, 23)]
    + [(ADAM, after) for after in (1, 4, 11)],
)
def test_the_conv_autoencoder_ends_in_the_same_bits(tmp_path, monkeypatch, schedule, after):
    whole = train_conv(None, schedule=schedule)
    with monkeypatch.context() as patch, pytest.raises(Interrupted):
        interrupt(patch, layerwise, after)
        train_conv(tmp_path / "c.npz", schedule=schedule)
    for _ in range(2):  # the second time from its very end
        assert same(whole, train_conv(tmp_path / "c.npz", resume=True, schedule=schedule))


@pytest.mark.parametrize("after", [0, 3, 4])
def test_the_sequential_autoencoder_ends_in_the_same_bits(tmp_path, monkeypatch, after):
    whole = train_sequence(None)
    with monkeypatch.context() as patch, pytest.raises(Interrupted):
        interrupt(patch, sequential, after)
        train_sequence(tmp_path / "c.npz")
    assert same(whole, train_sequence(tmp_path / "c.npz", resume=True))


def test_a_checkpoint_is_not_overwritten_unasked_nor_used_for_another_run(tmp_path):
    path = tmp_path / "c.npz"
    train_conv(path)
    before = path.read_bytes()
    with pytest.raises(CheckpointError, match="--resume"):
        train_conv(path)
    with pytest.raises(CheckpointError, match="other motions"):
        train_conv(path, resume=True, windows=WINDOWS * 2)
    with pytest.raises(CheckpointError, match="other motions"):
        train_conv(path, resume=True, schedule=Schedule(Stage(epochs=1), Stage(epochs=1)))
    assert path.read_bytes() == before


def test_a_checkpoint_that_is_damaged(tmp_path):
    path = tmp_path / "c.npz"
    train_conv(path)
    data = path.read_bytes()
    for changed in (data[:100], b"", data[: len(data) // 2] + b"x" * 50 + data[len(data) // 2 :]):
        path.write_bytes(changed)
        with pytest.raises(CheckpointError, match="not a checkpoint of this version"):
            train_conv(path, resume=True)


def edited(arrays, rng):
    """One array or a value in the JSON text replaced, removed or renamed."""
    names = sorted(arrays)
    name = names[rng.integers(len(names))]
    array = arrays[name]
    if name == "about":
        about = json.loads(str(array))
        part = rng.choice(["run", "rng", "position", "history"])
        values = (None, [], {}, 10**400, -1, "text", 1e300, [[]], {"stage": -5})
        about[part] = values[rng.integers(len(values))]
        return arrays | {name: np.array(json.dumps(about))}
    number = rng.normal() * 10.0 ** rng.integers(-3, 300)
    choices = [
        lambda: array.astype("U20"),
        lambda: np.ones(array.shape, complex),
        lambda: array[..., :1] if array.ndim else np.zeros(3),
        lambda: np.zeros(array.shape, np.float16),
        lambda: np.full(array.shape, np.nan),
        lambda: array.astype(float) + number if array.dtype.kind in "if" else np.array(number),
        lambda: np.zeros((0, 3)),
    ]
    new = {} if rng.random() < 0.2 else {name: choices[rng.integers(len(choices))]()}
    return {key: value for key, value in arrays.items() if key != name} | new


@pytest.mark.parametrize("count", [30, pytest.param(2000, marks=pytest.mark.thorough)])
def test_an_edited_checkpoint_is_refused_or_gives_finite_weights(
    tmp_path, monkeypatch, count, counted
):
    path, refused = tmp_path / "c.npz", 0
    with monkeypatch.context() as patch, pytest.raises(Interrupted):
        interrupt(patch, layerwise, 18)
        train_conv(path)
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    for number in range(count):
        changed = edited(arrays, np.random.default_rng(number))
        np.savez(path, **changed)
        try:
            result = train_conv(path, resume=True)
        except (CheckpointError, ValueError) as error:
            refused += 1
            assert "\n" not in str(error), number
        else:
            assert all(np.isfinite(array).all() for array in result[0]), number
    assert refused > count / 2
    if count > 1000:
        counted(f"{count} edited checkpoints: {refused} refused")


def test_a_full_disk_leaves_the_last_good_state(tmp_path, monkeypatch):
    whole = train_conv(None)
    path, written = tmp_path / "c.npz", [0]
    fsync = os.fsync

    def full(number):
        written[0] += 1
        if written[0] > 8:  # two for each state: the file and its folder
            raise OSError(errno.ENOSPC, "No space left on device")
        fsync(number)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(CheckpointError, match=r"No space left.*stage 1, 1 epochs and 0 steps"):
            train_conv(path)
    assert [each.name for each in tmp_path.iterdir()] == ["c.npz"]
    assert same(whole, train_conv(path, resume=True))


@pytest.mark.parametrize(
    ("owner", "name", "calls"), [(zipfile.ZipFile, "close", 4), (os, "fsync", 8)]
)
def test_ctrl_c_while_a_state_is_written_leaves_the_old_one(
    tmp_path, monkeypatch, owner, name, calls
):
    """Four states are kept, and what the fifth leaves open is collected silently."""
    whole, path, made, complaints = train_conv(None), tmp_path / "c.npz", [0], []
    function = getattr(owner, name)

    def pressed(argument):
        made[0] += 1
        if made[0] == calls + 1:
            raise KeyboardInterrupt
        return function(argument)

    with monkeypatch.context() as patch:
        patch.setattr(sys, "unraisablehook", complaints.append)
        patch.setattr(owner, name, pressed)
        with pytest.raises(KeyboardInterrupt):
            train_conv(path)
        gc.collect()
    assert made[0] > calls and complaints == []
    assert [each.name for each in tmp_path.iterdir()] == ["c.npz"]
    assert same(whole, train_conv(path, resume=True))


def test_divergence_names_window_layer_and_checkpoint_and_keeps_only_finite_states(tmp_path):
    path = tmp_path / "c.npz"
    schedule = Schedule(Stage(epochs=1, rate=0.1), Stage(5, 1e20, 1.0, 0.0))
    with pytest.raises(DivergedError) as failure, np.errstate(all="ignore"):
        train_conv(path, schedule=schedule)
    said = str(failure.value)
    assert said.startswith("fine tuning, epoch 1")
    assert "first in the output of fine tuning, windows" in said
    assert f"the last good state is in {path} (stage " in said
    with np.load(path) as file:
        assert all(np.isfinite(file[name]).all() for name in file.files if "array" in name)


def test_how_often_by_time(tmp_path, monkeypatch):
    saved = []
    monkeypatch.setattr(Checkpoint, "save", lambda self, loop: saved.append(loop.position.step))
    model = ConvAutoencoder(3, (4, 5), taps=3)
    kept = Checkpoint(tmp_path / "c.npz", seconds=1e9)
    train_autoencoder(model, WINDOWS, SCHEDULE, None, False, kept)
    assert saved == [0] * 6
