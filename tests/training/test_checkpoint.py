"""Interrupted anywhere and resumed, training ends bit-identical; no good state is lost."""

import errno
import gc
import os
import sys
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import (
    Checkpoint,
    CheckpointError,
    DivergedError,
    TrainingState,
    checkpoint,
)
from numpy_cae.training.layerwise import train_autoencoder
from numpy_cae.training.schedule import Schedule, SequenceSchedule, Stage
from numpy_cae.training.sequential import train_sequential

WINDOWS = np.random.default_rng(0).normal(scale=0.3, size=(7, 8, 3)).astype(np.float32)
# Three stages of two epochs of four steps.
FINE = Stage(epochs=2, rate=0.01, batch=2, momentum=0.9)
SCHEDULE = Schedule(Stage(epochs=2, batch=2), FINE)
BY_ADAM = replace(FINE, optimiser="adam", momentum=0.0)
ADAM = Schedule(replace(BY_ADAM, epochs=1, rate=0.5), BY_ADAM)
SHORT = SequenceSchedule(epochs=2, steps=4, batch=4, directions=4, momentum=0.9)


def draw(rng, batch):
    return rng.normal(size=(batch, 6, 3)).astype(np.float32)


class Interrupted(Exception):
    """Raised by a report."""


def interrupt(after):
    """A report that raises once so many steps have been made."""
    steps = iter(range(after))

    def report(state):
        if next(steps, None) is None:
            raise Interrupted

    return report


def train(path=None, schedule=SCHEDULE, windows=WINDOWS, report=None, bound=0.9, resume=False):
    """The weights by name, and the losses of each stage."""
    file = path and Checkpoint(path, 0.0, resume)
    rng = np.random.default_rng(0)
    if isinstance(schedule, Schedule):
        model = ConvAutoencoder(3, (4, 5), taps=3, bound=bound, rng=rng)
        state = train_autoencoder(model, windows, schedule, 1, report, file)
        return model.parameters, state.losses
    model = SequentialAutoencoder(3, 5, 2, rng)
    state = train_sequential(model, draw, schedule, 1, report, file)
    return model.weights, state.losses


def are_equal(first, second):
    """Whether the weights and the losses are equal to the last bit."""
    weights, losses = first
    weights_2, losses_2 = second
    equal = [np.array_equal(weights[name], weights_2[name]) for name in weights_2]
    return all(equal) and losses == losses_2


@pytest.mark.parametrize(
    ("schedule", "after"),
    [(SCHEDULE, after) for after in (0, 3, 4, 7, 8, 16, 23)]
    + [(ADAM, after) for after in (1, 4, 11)]
    + [(SHORT, after) for after in (0, 3, 4)],
)
def test_a_resumed_run_is_bit_identical(tmp_path, schedule, after):
    uninterrupted = train(schedule=schedule)
    with pytest.raises(Interrupted):
        train(tmp_path / "c.npz", schedule, report=interrupt(after))
    for _ in range(2):  # the second time from its very end
        assert are_equal(uninterrupted, train(tmp_path / "c.npz", schedule, resume=True))


def test_the_seconds_of_the_interrupted_run_count():
    state = TrainingState(seconds={"layer 1": 1000.0})
    state.begin_stage("layer 1", epochs=1, steps=2)
    state.count_step(1.0, examples=1)
    assert 1000 <= state.seconds["layer 1"] < 1001


@pytest.mark.parametrize("schedule", [SCHEDULE, SHORT])
def test_a_checkpoint_is_not_overwritten_unasked(tmp_path, schedule):
    path = tmp_path / "c.npz"
    assert Checkpoint(path).status() == "no state has been saved yet"
    train(path, schedule)
    before = path.read_bytes()
    with pytest.raises(CheckpointError, match="--resume"):
        train(path, schedule)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("schedule", "changed"),
    [
        (SCHEDULE, {"windows": WINDOWS * 2}),
        (SCHEDULE, {"windows": WINDOWS.reshape(14, 4, 3)}),
        (SCHEDULE, {"bound": 0.8}),
        (SCHEDULE, {"schedule": ADAM}),
        (SHORT, {"schedule": replace(SHORT, rate=0.1)}),
    ],
)
def test_a_checkpoint_is_not_used_for_another_run(tmp_path, schedule, changed):
    path = tmp_path / "c.npz"
    train(path, schedule)
    before = path.read_bytes()
    with pytest.raises(CheckpointError, match="other motions"):
        train(path, **{"schedule": schedule} | changed, resume=True)
    assert path.read_bytes() == before


def test_a_checkpoint_of_another_version_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "c.npz"
    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "FORMAT", "numpy_cae checkpoint 5")
        train(path)
    with pytest.raises(CheckpointError, match="not a checkpoint of this version"):
        train(path, resume=True)


def test_a_checkpoint_that_is_damaged(tmp_path):
    path = tmp_path / "c.npz"
    train(path)
    data = path.read_bytes()
    for changed in (data[:100], data[: len(data) // 2] + b"x" * 50 + data[len(data) // 2 :]):
        path.write_bytes(changed)
        with pytest.raises(CheckpointError, match="not a checkpoint of this version"):
            train(path, resume=True)


@pytest.mark.parametrize(
    ("owner", "name", "failure"),
    [
        (zipfile.ZipFile, "close", KeyboardInterrupt()),
        (os, "fsync", KeyboardInterrupt()),
        (os, "fsync", OSError(errno.ENOSPC, "No space left on device")),
    ],
)
def test_a_failure_while_a_state_is_written_leaves_the_old_one(
    tmp_path, monkeypatch, owner, name, failure
):
    """Four states are saved, and what the fifth leaves open is collected silently."""
    path = tmp_path / "c.npz"
    calls = []
    complaints = []
    function = getattr(owner, name)

    def fail_at_the_fifth_call(argument):
        calls.append(argument)
        if len(calls) == 5:
            raise failure
        return function(argument)

    with monkeypatch.context() as patch:
        patch.setattr(sys, "unraisablehook", complaints.append)
        patch.setattr(owner, name, fail_at_the_fifth_call)
        with pytest.raises((KeyboardInterrupt, CheckpointError)) as raised:
            train(path)
        gc.collect()
    assert len(calls) > 4 and complaints == []
    if isinstance(failure, OSError):
        message = r"No space left.*\(layer 1, 1 epochs and 0 steps done\)\. Correct"
        assert raised.type is CheckpointError and raised.match(message)
    assert [file.name for file in tmp_path.iterdir()] == ["c.npz"]
    assert are_equal(train(), train(path, resume=True))


def test_divergence_names_the_part_and_the_checkpoint_which_keeps_only_finite_states(tmp_path):
    path = tmp_path / "c.npz"
    schedule = Schedule(Stage(epochs=1, rate=0.1), Stage(epochs=5, rate=1e20, decay=1.0))
    with pytest.raises(DivergedError) as failure, np.errstate(all="ignore"):
        train(path, schedule)
    message = str(failure.value)
    assert message.startswith("fine tuning, epoch 1, step ")
    assert "not finite: the output of fine tuning;" in message
    assert f"the last good state is in {path} (" in message
    with np.load(path) as file:
        assert all(np.isfinite(file[name]).all() for name in file.files if "array" in name)


def test_within_an_epoch_a_state_is_saved_only_when_the_last_one_is_old(tmp_path, monkeypatch):
    saved = []
    monkeypatch.setattr("time.monotonic", lambda: 5.0)  # no time passes: 0 s after the last one
    monkeypatch.setattr(Checkpoint, "save", lambda self, state: saved.append(state.step))
    for seconds in (1e9, 0.0):
        model = ConvAutoencoder(3, (4, 5))
        interval = Checkpoint(tmp_path / "c.npz", seconds)
        train_autoencoder(model, WINDOWS, SCHEDULE, checkpoint=interval)
    assert saved == [0] * 6 + [1, 2, 3, 0] * 6
