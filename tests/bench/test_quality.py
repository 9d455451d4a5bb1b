"""Trainings in turns: the order, the times to the same error, the table."""

import json
import time
from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.bench import convolutional_quality, quality
from numpy_cae.bench.convolutional import torch
from numpy_cae.bench.quality import Quality, Training, train_in_turns
from numpy_cae.cli import main, train_options
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import write_bvh
from numpy_cae.training import Schedule, Stage, train_autoencoder

if torch is not None:
    torch.set_num_threads(1)  # no time is compared here

STAGE = Stage(
    8, 0.001, 1.0, 0.0, 2, (0.1, 0.8), True, norm=1.0, optimiser="adam", rate_schedule="one-cycle"
)


def training(name, errors, called):
    left = iter(errors)

    def turns():
        for _ in errors:
            called.append(name)
            yield

    return Training(name, len(errors), turns(), lambda: next(left))


def test_the_training_with_the_smallest_share_done_has_the_next_turn():
    called, lines = [], []
    trainings = [training("a", [3, 2], called), training("b", [5, 4, 3, 2], called)]
    train_in_turns(trainings, lines.append)
    assert "".join(called) == "abbabb"
    assert trainings[1].errors == [5, 4, 3, 2]
    assert sorted(trainings[1].seconds) == trainings[1].seconds
    assert lines[-1].startswith("b, 4/4: ")


def test_measuring_is_not_timed(monkeypatch):
    now = [0.0]

    def pass_time(seconds, result):
        now[0] += seconds
        return result

    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    turns = (pass_time(2.0, None) for _ in range(3))
    one = Training("a", 3, turns, lambda: pass_time(10.0, 1.0))
    train_in_turns([one])
    assert one.seconds == [2.0, 4.0, 6.0]


def test_the_target_is_the_lowest_error_that_all_reach():
    ours, theirs = training("ours", [], []), training("theirs", [], [])
    ours.seconds, ours.errors = [2.0, 4.0, 6.0], [3.0, 1.9, 1.0]
    theirs.seconds, theirs.errors = [5.0, 10.0, 15.0], [4.0, 2.0, 2.1]
    quality = Quality([ours, theirs], "cm")
    assert quality.target == 2.0
    assert quality.ratios == {"ours": 1.0, "theirs": pytest.approx(10 / 4)}
    assert "seconds to 2.000 cm" in quality.text()
    assert "| theirs | 10.0 | 2.50 | 15.0 | 2.000 |" in quality.text()
    assert quality.data()["courses"]["theirs"]["errors"] == [4.0, 2.0, 2.1]


def test_our_training_is_that_of_numpy_cae_train():
    windows = np.random.default_rng(1).normal(size=(10, 16, 63)).astype(np.float32) / 4
    trained, expected = (ConvAutoencoder(filters=(3, 4, 5), taps=3) for _ in range(2))
    for _ in convolutional_quality.epochs(trained, windows, STAGE):
        pass
    schedule = Schedule(Stage(epochs=0), STAGE)
    train_autoencoder(expected, windows, schedule, np.random.default_rng(0), show_progress=False)
    for name, weight in trained.parameters.items():
        np.testing.assert_array_equal(weight, expected.parameters[name])


@pytest.mark.skipif(torch is None, reason="PyTorch is not installed")
def test_all_networks_learn(monkeypatch, capsys, tmp_path):
    for seed in range(4):
        take = make_take("walk", seed, seconds=3.0, rate=30.0)
        write_bvh(take.motion, tmp_path / f"walk_{seed}.bvh", unit=0.01)
    usual = replace(convolutional_quality.USUAL, epochs=9, batch=2)
    monkeypatch.setattr(convolutional_quality, "USUAL", usual)
    monkeypatch.setitem(train_options.RECIPES, "fast", Schedule(Stage(epochs=0), STAGE))
    files = ["--data", str(tmp_path), "--test", "*_3.bvh"]
    assert main(["bench", "--quality", "--json", *files]) == 0
    courses = json.loads(capsys.readouterr().out)["courses"]
    assert [len(course["errors"]) for course in courses.values()] == [8, 9, 8]
    for course in courses.values():
        assert course["errors"][-1] < course["errors"][0]


def test_without_pytorch_or_with_two_measurements_the_command_says_what_to_do(monkeypatch, capsys):
    assert main(["bench", "--quality", "--paper"]) == 2
    assert "give one of them" in capsys.readouterr().err
    monkeypatch.setattr(quality, "torch", None)
    assert main(["bench", "--quality"]) == 2
    assert "PyTorch, which is not installed" in capsys.readouterr().err
