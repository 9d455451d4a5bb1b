"""The trainings of the study `speed`: their order, what is timed, and that all learn."""

import time
from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.training import Schedule, SequenceSchedule, Stage, zero_values
from studies.timing import time_to_quality as script
from studies.timing.torch_convolutional import torch

ADAM = {"batch": 8, "optimiser": "adam", "rate_schedule": "one-cycle"}


def test_turns_are_shared_and_only_training_is_timed(monkeypatch):
    now, called = [0.0], []

    def passes(seconds, name, result=None):
        now[0] += seconds
        called.append(name)
        return result

    def training(name, count):
        turns = (passes(2.0, name) for _ in range(count))
        return script.Training(name, count, turns, lambda: passes(10.0, "", 1.0))

    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    both = [training("a", 2), training("b", 4)]
    script.train_in_turns(both)
    assert "".join(called) == "abbabb"
    assert [each.seconds for each in both] == [[2.0, 4.0], [2.0, 4.0, 6.0, 8.0]]


def test_the_target_is_the_lowest_error_that_all_reach():
    ours = script.Training("ours", 3, iter(()), float, [2.0, 4.0, 6.0], [3.0, 1.9, 1.0])
    theirs = script.Training("theirs", 3, iter(()), float, [5.0, 10.0, 15.0], [4.0, 2.0, 2.1])
    table = script.quality([ours, theirs], "cm")
    assert table.header[1] == "seconds to 2.000 cm"
    assert table.rows[1] == ["theirs", 10.0, 2.5, 15.0, 2.0]


@pytest.mark.skipif(torch is None, reason="PyTorch is not installed")
@pytest.mark.parametrize("sequential", [False, True])
def test_all_networks_learn(monkeypatch, sequential):
    torch.set_num_threads(1)  # no time is compared here
    rng = np.random.default_rng(3)
    if sequential:
        schedule = SequenceSchedule(epochs=2, steps=20, rate=0.01, **ADAM)
        monkeypatch.setattr(script, "USUAL_SEQUENCES", replace(schedule, epochs=3))
        monkeypatch.setattr(script, "HIDDEN", 12)

        def waves(rng, batch):
            phases = rng.uniform(0, 6, size=(batch, 1, 1)) + np.arange(3)
            return np.sin(np.arange(6)[:, None] / 2 + phases).astype(np.float32)

        made = script.sequence_trainings(waves, waves(rng, 50), schedule)
    else:
        stage = Stage(epochs=6, rate=0.001, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True, **ADAM)
        stage = replace(stage, batch=2, norm=1.0)
        monkeypatch.setattr(script, "USUAL", replace(script.USUAL, epochs=7, batch=2))
        waves = np.sin(np.arange(160)[:, None] / 8 + rng.uniform(0, 6, (4, 1, 63)))
        x = (waves / 4).astype(np.float32)
        lost = zero_values(x, 0.5, np.random.default_rng(0))
        made = script.trainings(
            x, Schedule(Stage(epochs=0), stage), lambda f: np.mean((f(lost) - x) ** 2)
        )
    script.train_in_turns(made)
    assert all(each.errors[-1] < each.errors[0] for each in made)
