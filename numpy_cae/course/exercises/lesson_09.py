"""The exercises of lesson 09, memory: a GRU, backpropagation through time, and clipping."""

import numpy as np

from numpy_cae.course.exercises.checks import (
    Recorded,
    drawn,
    require_parts,
    require_same,
    size,
    states,
)
from numpy_cae.course.exercises.exercise import exercise, operation_exercise
from numpy_cae.course.solutions.lesson_09 import (
    clip_gradients,
    gate_gradients,
    norms_through_time,
)
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import Property, require_equal

OF_NORM = 0.25
"""The bound of clipping, as a part of the norm."""


def _linear_pullback(case: Case, rng: np.random.Generator) -> Recorded:
    """The pullback of a recurrence with one matrix for each frame: dh_(t-1) = dh_t · M_t."""
    matrices = spread(rng, (case["frames"], case["hidden"], case["hidden"]), 1.5)

    def pull(t: int, dh: np.ndarray) -> np.ndarray:
        if not 1 <= t <= len(matrices):
            raise IndexError(f"pull has the frames 1 to {len(matrices)}, got {t}")
        return dh @ matrices[t - 1]

    text = f"lambda t, dh: dh @ np.array({np.round(matrices, 4).tolist()})[t - 1]"
    return Recorded(text, pull)


def _clip_arguments(case: Case) -> dict[str, object]:
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


BEYOND = "beyond the bound, every array times bound / norm; and the norm before clipping"


@states("value", BEYOND)
def _beyond_bound(function, case, gradients, bound):
    _require_clipped(function, gradients, bound, OF_NORM)


@states("left alone", "within the bound, the gradients are not changed")
def _within_bound(function, case, gradients, bound):
    _require_clipped(function, gradients, 1.5 * _norm(gradients), 1.0)


@states("nothing", "gradients of zeros stay zeros")
def _zero_gradients(function, case, gradients, bound):
    _require_clipped(function, [np.zeros_like(each) for each in gradients], 1.0, 1.0)


STATE = "batch hidden"


def _gate(case: Case, rng: np.random.Generator) -> np.ndarray:
    return 0.5 + spread(rng, (case["batch"], case["hidden"]), 0.4)


GATE_GRADIENTS = ("da_r", "da_z", "da_n", "ds_n")


def _is_right(number: int) -> Property:
    """One of the four gradients, by itself: a wrong one does not hide the others."""
    name = GATE_GRADIENTS[number]

    def check(function, case, **given):
        returned = require_parts(function(*given.values()), GATE_GRADIENTS)
        require_same(returned[number], gate_gradients(**given)[number], (name,))

    return states(name, f"{name} is right")(check)


EXERCISES = (
    exercise(
        norms_through_time,
        drawn(pull=_linear_pullback, dh="batch hidden", frames=size("frames")),
        {"batch": (1, 2), "hidden": (1, 2, 3), "frames": (1, 2, 3, 4)},
        value="entry t is the norm of dL/dh_t, from t = 0 to the last frame",
    ),
    operation_exercise("sigmoid"),
    exercise(
        gate_gradients,
        drawn(
            dh_next=STATE,
            h=STATE,
            r=_gate,
            z=_gate,
            n=STATE,
            s_n=STATE,
        ),
        {"batch": (1, 2), "hidden": (1, 2, 3)},
        *map(_is_right, (2, 1, 3, 0)),  # as they are computed, from the last line to the first
    ),
    operation_exercise("gru_step", given="linear mean_squared_error tanh"),
    operation_exercise("gru"),
    exercise(
        clip_gradients,
        _clip_arguments,
        {"arrays": (1, 2, 3), "rows": (1, 2)},
        _beyond_bound,
        _within_bound,
        _zero_gradients,
    ),
)
