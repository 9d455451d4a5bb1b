"""The checks and arguments of lesson 14, beyond the papers: losses with which projects begin."""

import numpy as np

from numpy_cae.course.exercises.checks import checks, require_parts, require_same
from numpy_cae.course.exercises.differentiated import PULLBACK
from numpy_cae.course.solutions.lesson_14 import observed_error
from numpy_cae.verify.operations.case import Case, spread

TREES = {2: (-1, 0), 3: (-1, 0, 1), 4: (-1, 0, 0, 2)}
RETURNS = ("the loss", PULLBACK)


def bone_arguments(case: Case) -> dict[str, object]:
    """Joints, the lengths of their bones and their parents."""
    rng = case.rng()
    q = spread(rng, (case["frames"], case["joints"], 3))
    lengths = rng.uniform(0.2, 0.6, case["joints"])
    return {"q": q, "lengths": lengths, "parents": TREES[case["joints"]]}


def observed_arguments(case: Case) -> dict[str, object]:
    """Values, a reconstruction, and which of them are known."""
    rng = case.rng()
    shape = (case["frames"], case["channels"])
    known = rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
    return {"x_hat": spread(rng, shape), "x": rng.permutation(spread(rng, shape)), "known": known}


@checks("bones_off", "upstream default")
@checks("path_energy", "upstream default")
@checks("observed_error", "upstream default")
def _upstream_is_one(function, case, **given):
    _, pullback = require_parts(function(*given.values()), RETURNS)
    require_same(pullback(), pullback(1.0), ("the gradient without an argument",))


@checks("observed_error", "unknown is NaN")
def _unknown_values(function, case, x_hat, x, known):
    x = np.where(known, x, np.nan)
    loss, pullback = require_parts(function(x_hat, x, known), RETURNS)
    require_same(loss, observed_error(x_hat, x, known)[0], ("the loss",))
    gradient = pullback()
    if np.shape(gradient) == known.shape:  # another shape is what the gradient's property says
        require_same(gradient * ~known, 0 * known, ("the gradient of an unknown value",))
