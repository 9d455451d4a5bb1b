"""The checks and arguments of lesson 08, using the manifold.

Repair with an unknown mask, filling in, comparing, and the linear map as a baseline.
"""

import numpy as np

from numpy_cae.course.exercises.checks import checks, require_same
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import agrees

BLURRED = "lambda x: 0.75 * x + 0.25 * np.roll(x, 1, axis=1) + 0.1"
"""BLURRED: a projection, a mean of each frame and the one before it, that changes every window."""
WITH_MEAN = "lambda x, known: np.where(known, x, np.mean(x[known]))"
"""WITH_MEAN: an interpolation as simple as it can be."""


def damaged_arguments(case: Case) -> dict[str, object]:
    """Windows whose values were set to zero, and features that are zero in all frames."""
    rng = case.rng()
    batch, frames, channels = (case[name] for name in ("batch", "frames", "channels"))
    x = spread(rng, (batch, frames, channels))
    for window, channel in np.ndindex(batch, channels):
        lost = rng.permutation(frames)[: rng.integers(1, frames)]
        x[window, lost, channel] = 0.0
    still = np.zeros((batch, frames, case["still"]))
    still[1:, :, :1] = 1.0  # the first of them is still in the first window only
    return {"x": np.concatenate([x, still], axis=2)}


def moment_arguments(case: Case) -> dict[str, object]:
    """The moments of correlated random inputs z and outputs x."""
    rng = case.rng()
    inputs = case["inputs"]
    independent = rng.standard_normal((2 * inputs + 2, inputs))
    z = independent @ rng.standard_normal((inputs, inputs))
    x = z @ rng.standard_normal((inputs, case["outputs"])) + independent[:, :1]
    return {"second": z.T @ z / len(z), "cross": z.T @ x / len(z), "kept": case["tenths"] / 10}


def some_alike(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Which motions are alike."""
    return rng.permutation(np.arange(case["motions"]) < case["alike"])


@checks("complete", "known")
def _known_values_stay(function, case, x, known, **others):
    require_same(function(x, known, *others.values())[known], x[known], ("a known value",))


@checks("complete", "nothing there")
def _unknown_values_ignored(function, case, x, known, **others):
    number = function(x, known, *others.values())
    with_nan = function(np.where(known, x, np.nan), known, *others.values())
    if not agrees(with_nan, number):  # the function's own results: neither need be right
        raise AssertionError("NaN in place of the unknown values of x changes what it returns")
