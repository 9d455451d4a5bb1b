"""The checks and arguments of lesson 07b, better steps: momentum, Adam and a one-cycle rate."""

import numpy as np

from numpy_cae.course.exercises.checks import checks, require_parts
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal


def squares(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """A mean of squares, which is positive."""
    return spread(rng, (case["taps"], case["channels"])) ** 2


@checks("adam_step", "first step")
def _first_step(function, case, parameter, mean, square, gradient, rate, step):
    for factor in (1.0, 1e3):
        zero = np.zeros_like(parameter)
        returned = function(parameter, zero, zero, factor * gradient, rate, 1)
        moved, *_ = require_parts(returned, ("the parameter", "the mean", "the square"))
        what = f"for {factor:g} times the gradient, the size of a first step"
        require_equal(what, np.abs(moved - parameter), np.full(parameter.shape, rate), 1e-6)
