"""The checks and arguments of lesson 14, beyond the papers: losses with which projects begin."""

import numpy as np

from numpy_cae.course.exercises.checks import PULLBACK, checks, require_parts, require_same
from numpy_cae.course.solutions.lesson_14 import observed_error


@checks("observed_error", "unknown is NaN")
def _unknown_values(function, case, x_hat, x, known):
    x = np.where(known, x, np.nan)
    loss, pullback = require_parts(function(x_hat, x, known), ("the loss", PULLBACK))
    require_same(loss, observed_error(x_hat, x, known)[0], ("the loss",))
    gradient = pullback()
    if np.shape(gradient) == known.shape:  # another shape is what the gradient's property says
        require_same(gradient * ~known, 0 * known, ("the gradient of an unknown value",))
