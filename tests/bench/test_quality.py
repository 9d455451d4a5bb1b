"""Two trainings in turns: the order, the times to the same error, the table."""

import time

import pytest

from numpy_cae.bench.quality import Quality, Training, train_in_turns


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


def test_the_target_is_the_lowest_error_that_both_reach():
    ours, theirs = training("ours", [], []), training("theirs", [], [])
    ours.seconds, ours.errors = [2.0, 4.0, 6.0], [3.0, 1.9, 1.0]
    theirs.seconds, theirs.errors = [5.0, 10.0, 15.0], [4.0, 2.0, 2.1]
    quality = Quality(ours, theirs, "cm")
    assert quality.target == 2.0
    assert quality.ratio == pytest.approx(10 / 4)
    assert "| ours | 4.0 | 6.0 | 1.000 |" in quality.text()
    assert "ratio to 2.000 cm: 2.50" in quality.text()
    assert quality.data()["courses"]["theirs"]["errors"] == [4.0, 2.0, 2.1]
