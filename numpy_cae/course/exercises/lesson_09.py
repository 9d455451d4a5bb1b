"""The checks and arguments of lesson 09, memory: backpropagation through time, and clipping."""

import numpy as np

from numpy_cae.course.exercises.checks import Recorded, checks, require_parts, require_same
from numpy_cae.course.solutions.lesson_09 import gate_gradients
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal

GATE_GRADIENTS = ("da_r", "da_z", "da_n", "ds_n")
OF_NORM = 0.25
"""The bound of clipping, as a part of the norm."""


def linear_pullback(case: Case, rng: np.random.Generator, made: dict) -> Recorded:
    """The pullback of a recurrence with one matrix for each frame: dh_(t-1) = dh_t · M_t."""
    matrices = spread(rng, (case["frames"], case["hidden"], case["hidden"]), 1.5)
    text = f"lambda t, dh: dh @ np.array({np.round(matrices, 4).tolist()})[t - 1]"
    return Recorded(text)


def clip_arguments(case: Case) -> dict[str, object]:
    """Arrays of several shapes, with a norm beyond the bound."""
    rng = case.rng()
    shapes = [(case["rows"], 2), (2,), (1, case["rows"])][: case["arrays"]]
    gradients = [spread(rng, shape) for shape in shapes]
    return {"gradients": gradients, "bound": OF_NORM * _norm(gradients)}


def _norm(gradients) -> float:
    return float(np.sqrt(sum(entry**2 for each in gradients for entry in each.ravel())))


def _require_clipped(function, gradients, bound: float, factor: float) -> None:
    returned = function(gradients, bound)
    clipped, norm = require_parts(returned, ("the clipped gradients", "the norm"))
    require_parts(clipped, [f"gradient {number}" for number in range(len(gradients))])
    require_same(norm, _norm(gradients), ("the norm",))
    for number, (returned, gradient) in enumerate(zip(clipped, gradients, strict=True)):
        require_equal(f"gradient {number}", returned, factor * gradient)


@checks("clip_gradients", "value")
def _beyond_bound(function, case, gradients, bound):
    _require_clipped(function, gradients, bound, OF_NORM)


@checks("clip_gradients", "left alone")
def _within_bound(function, case, gradients, bound):
    _require_clipped(function, gradients, 1.5 * _norm(gradients), 1.0)


@checks("clip_gradients", "nothing")
def _zero_gradients(function, case, gradients, bound):
    _require_clipped(function, [np.zeros_like(each) for each in gradients], 1.0, 1.0)


def gate(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """A gate, between 0.1 and 0.9."""
    return 0.5 + spread(rng, (case["batch"], case["hidden"]), 0.4)


def _check_gate(number: int) -> None:
    """One of the four gradients, by itself: a wrong one does not hide the others."""
    name = GATE_GRADIENTS[number]

    @checks("gate_gradients", name)
    def check(function, case, **given):
        returned = require_parts(function(*given.values()), GATE_GRADIENTS)
        require_same(returned[number], gate_gradients(**given)[number], (name,))


for place in range(len(GATE_GRADIENTS)):
    _check_gate(place)
