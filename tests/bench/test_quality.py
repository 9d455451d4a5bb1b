"""Trainings in turns: the order, what is timed, the times to the same error, both networks."""

import time
from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.bench import quality, trainings
from numpy_cae.bench.convolutional import torch
from numpy_cae.bench.quality import Quality, Training, train_in_turns
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import Schedule, SequenceSchedule, Stage, recipe, train_autoencoder

STAGE = replace(recipe("fast").fine_tuning, epochs=4, rate=0.001, batch=2, norm=1.0)
SEQUENCES = SequenceSchedule(
    epochs=2, steps=20, rate=0.01, batch=8, optimiser="adam", rate_schedule="one-cycle"
)


def waves(rng, batch):
    """Clips of 6 frames of a sine at a phase drawn anew."""
    phases = rng.uniform(0, 2 * np.pi, size=(batch, 1, 1))
    return np.sin(np.arange(6)[None, :, None] / 2 + phases + np.arange(3)).astype(np.float32)


def test_turns_are_shared_and_only_training_is_timed(monkeypatch):
    now, called = [0.0], []

    def passes(seconds, name, result=None):
        now[0] += seconds
        called.append(name)
        return result

    def training(name, count):
        turns = (passes(2.0, name) for _ in range(count))
        return Training(name, count, turns, lambda: passes(10.0, "", 1.0))

    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    both = [training("a", 2), training("b", 4)]
    train_in_turns(both)
    assert "".join(called) == "abbabb"
    assert [each.seconds for each in both] == [[2.0, 4.0], [2.0, 4.0, 6.0, 8.0]]


def test_the_target_is_the_lowest_error_that_all_reach():
    ours = Training("ours", 3, iter(()), float, [2.0, 4.0, 6.0], [3.0, 1.9, 1.0])
    theirs = Training("theirs", 3, iter(()), float, [5.0, 10.0, 15.0], [4.0, 2.0, 2.1])
    text = Quality([ours, theirs], "cm").text()
    assert "seconds to 2.000 cm" in text
    assert "| theirs | 10.0 | 2.50 | 15.0 | 2.000 |" in text


def test_an_epoch_of_ours_is_one_of_numpy_cae_train():
    windows = np.random.default_rng(1).normal(size=(10, 16, 63)).astype(np.float32) / 4
    trained, expected = (ConvAutoencoder(filters=(3, 4, 5), taps=3) for _ in range(2))
    assert len(list(trainings.epochs(trained, windows, STAGE))) == STAGE.epochs
    train_autoencoder(expected, windows, Schedule(Stage(epochs=0), STAGE))
    for name, weight in trained.parameters.items():
        np.testing.assert_array_equal(weight, expected.parameters[name])


@pytest.mark.skipif(torch is None, reason="PyTorch is not installed")
def test_all_networks_learn(monkeypatch):
    torch.set_num_threads(1)  # no time is compared here
    monkeypatch.setattr(trainings, "USUAL", replace(trainings.USUAL, epochs=5, batch=2))
    monkeypatch.setattr(trainings, "USUAL_SEQUENCES", replace(SEQUENCES, epochs=3))
    monkeypatch.setattr(trainings, "HIDDEN", 12)
    monkeypatch.setattr(trainings, "ConvAutoencoder", lambda rng: ConvAutoencoder(63, (8, 9), 5))
    phases = np.random.default_rng(3).uniform(0, 6, (6, 1, 63))
    x = (np.sin(np.arange(160)[:, None] / 8 + phases) / 4).astype(np.float32)
    windows = trainings.trainings(x, STAGE, lambda repair: np.mean((repair(x) - x) ** 2))
    held_out = waves(np.random.default_rng(5), 50)
    for made, counts in (
        (windows, [4, 5, 4]),
        (trainings.sequence_trainings(waves, held_out, SEQUENCES), [2, 3, 2]),
    ):
        train_in_turns(made)
        assert [len(each.errors) for each in made] == counts
        assert all(each.errors[-1] < each.errors[0] for each in made)


def test_without_pytorch_the_command_says_so(monkeypatch, error_of):
    monkeypatch.setattr(quality, "torch", None)
    assert "PyTorch, which is not installed" in error_of("bench", "--quality")
