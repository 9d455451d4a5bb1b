"""The arguments of lesson 09, memory: backpropagation through time, and clipping."""

import numpy as np

from numpy_cae.course.exercises.checks import Recorded
from numpy_cae.verify.operations.case import Case, spread


def linear_pullback(case: Case, rng: np.random.Generator, made: dict) -> Recorded:
    """The pullback of a recurrence with one matrix for each frame: dh_(t-1) = dh_t · M_t."""
    matrices = spread(rng, (case["frames"], case["hidden"], case["hidden"]), 1.5)
    text = f"lambda t, dh: dh @ np.array({np.round(matrices, 4).tolist()})[t - 1]"
    return Recorded(text)


def clip_arguments(case: Case) -> dict[str, object]:
    """Arrays of several shapes, and a bound of so many quarters of their norm; of 0, zeros."""
    rng = case.rng()
    shapes = [(case["rows"], 2), (2,), (1, case["rows"])][: case["arrays"]]
    gradients = [spread(rng, shape) * (case["quarters"] > 0) + 0.0 for shape in shapes]
    norm = float(np.sqrt(sum(np.sum(each**2) for each in gradients)))
    return {"gradients": gradients, "bound": case["quarters"] / 4 * norm or 1.0}
