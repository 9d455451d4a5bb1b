"""Intervals of figures over takes, and rules."""

import numpy as np
import pytest

from studies.shared.judging import (
    Interval,
    agreed,
    all_of,
    bootstrap,
    mean_of,
    ratio_of_errors,
    root_mean_square,
)


def test_the_interval_of_a_mean_has_its_standard_error():
    values = np.random.default_rng(0).normal(3.0, 1.0, 400)
    interval = mean_of(values)
    assert interval.value == pytest.approx(values.mean())
    assert interval.high - interval.low == pytest.approx(4 * values.std() / 20, rel=0.1)


def test_a_ratio_of_proportional_errors_has_no_spread():
    theirs = np.abs(np.random.default_rng(0).normal(size=(30, 2)))
    ours = theirs * [0.25, 1.0]
    interval = ratio_of_errors(ours, theirs)
    assert (interval.value, interval.low, interval.high) == pytest.approx((0.5, 0.5, 0.5))


def test_the_error_of_takes_is_that_of_all_their_values():
    assert root_mean_square(np.array([[8.0, 2], [1, 7]])) == 1


def test_takes_are_drawn_together():
    numbers = np.arange(10.0)
    interval = bootstrap(lambda a, b: np.sum(a - b, axis=1), numbers, numbers)
    assert (interval.low, interval.high) == (0, 0)


@pytest.mark.parametrize(("bound", "fulfilled"), [(0.9, False), (1.0, None), (1.2, True)])
def test_a_bound_within_the_interval_is_undecided(bound, fulfilled):
    interval = Interval(1.0, 0.95, 1.1)
    assert interval.at_most(bound) is fulfilled


def test_a_rule_of_parts_needs_all_of_them():
    assert all_of(True, True) is True
    assert all_of(True, None) is None
    assert all_of(None, False) is False


def test_seeds_that_differ_do_not_decide():
    assert agreed([True, True]) is True
    assert agreed([True, False]) is None
    assert agreed([None, None]) is None
