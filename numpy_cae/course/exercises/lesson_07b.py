"""The checks and arguments of lesson 07b, better steps: momentum, Adam and a one-cycle rate."""

import numpy as np

from numpy_cae.course.exercises.checks import checks, require_parts, require_same
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal


def squares(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """A mean of squares, which is positive."""
    return spread(rng, (case["taps"], case["channels"])) ** 2


def share_of_training(case: Case, rng: np.random.Generator, made: dict) -> float:
    """How much of the training is over."""
    return case["hundredths"] / 100


@checks("momentum_step", "no momentum")
def _plain_step(function, case, parameter, velocity, gradient, rate, momentum):
    returned = function(parameter, velocity, gradient, rate, 0.0)
    moved, _ = require_parts(returned, ("the parameter", "the velocity"))
    require_same(moved, parameter - rate * gradient, ("the parameter",))


@checks("adam_step", "first step")
def _first_step(function, case, parameter, mean, square, gradient, rate, step):
    for factor in (1.0, 1e3):
        zero = np.zeros_like(parameter)
        returned = function(parameter, zero, zero, factor * gradient, rate, 1)
        moved, *_ = require_parts(returned, ("the parameter", "the mean", "the square"))
        what = f"for {factor:g} times the gradient, the size of a first step"
        require_equal(what, np.abs(moved - parameter), np.full(parameter.shape, rate), 1e-6)


@checks("one_cycle", "cycle")
def _three_places(function, case, peak, share):
    for at, part in ((0.0, 0.04), (0.3, 1.0), (1.0, 0.0)):
        require_equal(f"the rate after {at:.0%}", function(peak, at), part * peak)
