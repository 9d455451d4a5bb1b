"""Trainings in turns: the order, what is timed, the times to the same error, both networks."""

import time
from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.bench import quality, trainings
from numpy_cae.bench.convolutional import torch
from numpy_cae.bench.quality import Quality, Training, train_in_turns
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import (
    SEQUENCE_RECIPES,
    Schedule,
    SequenceSchedule,
    Stage,
    train_autoencoder,
    train_sequential,
    zero_values,
)

STAGE = Stage(
    epochs=8,
    rate=0.001,
    alpha=0.0,
    batch=2,
    zeroed=(0.1, 0.8),
    rescaled=True,
    norm=1.0,
    optimiser="adam",
    rate_schedule="one-cycle",
)
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


def test_our_training_is_that_of_numpy_cae_train():
    windows = np.random.default_rng(1).normal(size=(10, 16, 63)).astype(np.float32) / 4
    trained, expected = (ConvAutoencoder(filters=(3, 4, 5), taps=3) for _ in range(2))
    assert len(list(trainings.epochs(trained, windows, STAGE))) == STAGE.epochs
    schedule = Schedule(Stage(epochs=0), STAGE)
    train_autoencoder(expected, windows, schedule, np.random.default_rng(0))
    for name, weight in trained.parameters.items():
        np.testing.assert_array_equal(weight, expected.parameters[name])


@pytest.mark.skipif(torch is None, reason="PyTorch is not installed")
def test_all_networks_learn(monkeypatch):
    torch.set_num_threads(1)  # no time is compared here
    usual = replace(trainings.USUAL, epochs=9, batch=2)
    monkeypatch.setattr(trainings, "USUAL", usual)
    phases = np.random.default_rng(3).uniform(0, 6, (6, 1, 63))
    x = (np.sin(np.arange(160)[:, None] / 8 + phases) / 4).astype(np.float32)
    lost = zero_values(x, 0.5, np.random.default_rng(0))
    made = trainings.trainings(x, STAGE, lambda f: np.mean((f(lost) - x) ** 2))
    train_in_turns(made)
    assert [len(each.errors) for each in made] == [8, 9, 8]
    assert all(each.errors[-1] < each.errors[0] for each in made)


def test_our_training_of_sequences_is_that_of_numpy_cae_train():
    trained, expected = (
        SequentialAutoencoder(3, 7, 2, np.random.default_rng(0), burn_in=2) for _ in range(2)
    )
    assert len(list(trainings.sequence_epochs(trained, waves, SEQUENCES))) == SEQUENCES.epochs
    train_sequential(expected, waves, SEQUENCES, np.random.default_rng(0))
    for name, weight in trained.weights.items():
        np.testing.assert_array_equal(weight, expected.weights[name])


@pytest.mark.skipif(torch is None, reason="PyTorch is not installed")
def test_all_sequential_networks_learn(monkeypatch):
    monkeypatch.setattr(trainings, "USUAL_SEQUENCES", replace(SEQUENCES, epochs=3))
    monkeypatch.setattr(trainings, "HIDDEN", 12)
    held_out = waves(np.random.default_rng(5), 50)
    made = trainings.sequence_trainings(waves, held_out, SEQUENCES)
    train_in_turns(made)
    assert [len(each.errors) for each in made] == [2, 3, 2]
    assert all(each.errors[-1] < each.errors[0] for each in made)


@pytest.mark.skipif(torch is None, reason="PyTorch is not installed")
def test_the_command_trains_sequences_on_synthetic_walking(monkeypatch, run, capsys):
    monkeypatch.setattr("numpy_cae.cli.commands.bench.SEQUENCE_MINUTES", 0.3)
    monkeypatch.setattr(trainings, "USUAL_SEQUENCES", SEQUENCES)
    monkeypatch.setitem(SEQUENCE_RECIPES, "fast", SEQUENCES)
    run("bench", "--quality", "--sequential", "--quiet")
    assert "| PyTorch, our settings |" in capsys.readouterr().out


def test_without_pytorch_the_command_says_so(monkeypatch, error_of):
    monkeypatch.setattr(quality, "torch", None)
    assert "PyTorch, which is not installed" in error_of("bench", "--quality")
