"""The exercises of lesson 09, memory: a GRU, backpropagation through time, and clipping."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from numpy_cae.course.exercises.checks import claim, drawn, require_parts, require_same, size
from numpy_cae.course.exercises.exercise import Exercise, exercise, operation_exercise
from numpy_cae.training import clip_norm
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.property import require_equal


@dataclass(frozen=True)
class LinearPullback:
    """The pullback of a recurrence with one matrix for each frame: dh_(t-1) = dh_t · M_t."""

    matrices: np.ndarray = field(repr=False)

    def __call__(self, t: int, dh: np.ndarray) -> np.ndarray:
        if not 1 <= t <= len(self.matrices):
            raise IndexError(f"pull has the frames 1 to {len(self.matrices)}, got {t}")
        return dh @ self.matrices[t - 1]

    def __repr__(self) -> str:
        return f"lambda t, dh: dh @ np.array({np.round(self.matrices, 4).tolist()})[t - 1]"


def norms_through_time(pull, dh, frames):
    """|dL/dh_t| for t = 0, ..., frames."""
    norms = np.empty(frames + 1)
    norms[frames] = np.linalg.norm(dh)
    for t in range(frames, 0, -1):
        dh = pull(t, dh)
        norms[t - 1] = np.linalg.norm(dh)
    return norms


def clip_gradients(gradients, bound):
    """g · min(1, bound / |g|) as new arrays, and |g|."""
    clipped = [each.copy() for each in gradients]
    norm = clip_norm(clipped, bound)
    return clipped, norm


def _linear_pullback(case: Case, rng: np.random.Generator) -> LinearPullback:
    shape = (case["frames"], case["hidden"], case["hidden"])
    return LinearPullback(spread(rng, shape, 1.5))


_pullback_arguments = drawn(pull=_linear_pullback, dh="batch hidden", frames=size("frames"))


def _clip_arguments(case: Case, bound_over_norm: float = 0.25) -> dict[str, object]:
    """Arrays of several shapes."""
    rng = case.rng()
    shapes = [(case["rows"], 2), (2,), (1, case["rows"])][: case["arrays"]]
    gradients = [spread(rng, shape) for shape in shapes]
    return {"gradients": gradients, "bound": bound_over_norm * _norm(gradients)}


def _norm(gradients) -> float:
    return float(np.sqrt(sum(entry**2 for each in gradients for entry in each.ravel())))


def _require_clipped(function, gradients, bound: float, factor: float) -> None:
    returned = function([g.copy() for g in gradients], bound)
    clipped, norm = require_parts(returned, ("the clipped gradients", "the norm"))
    require_parts(clipped, [f"gradient {number}" for number in range(len(gradients))])
    require_same(norm, _norm(gradients), ("the norm",))
    for number, (found, g) in enumerate(zip(clipped, gradients, strict=True)):
        require_equal(f"gradient {number}", found, factor * g)


@claim("value", "beyond the bound, every array times bound / norm; and the norm before clipping", 2)
def _beyond_bound(function, case: Case) -> None:
    _require_clipped(function, *_clip_arguments(case).values(), 0.25)


@claim("left alone", "within the bound, the gradients are not changed")
def _within_bound(function, case: Case) -> None:
    _require_clipped(function, *_clip_arguments(case, 1.5).values(), 1.0)


@claim("nothing", "gradients of zeros stay zeros")
def _zero_gradients(function, case: Case) -> None:
    gradients = [np.zeros_like(each) for each in _clip_arguments(case)["gradients"]]
    with np.errstate(all="ignore"):
        _require_clipped(function, gradients, 1.0, 1.0)


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        norms_through_time,
        "begin at the last frame with the given dh; before each step back, store its norm; "
        "pull(t, dh) goes from frame t to frame t - 1",
        _pullback_arguments,
        {"batch": (1, 2), "hidden": (1, 2, 3), "frames": (1, 2, 3, 4)},
        value="entry t is the norm of dL/dh_t, from t = 0 to the last frame",
        points=3,
        hints={"value": "there is one norm more than there are steps: h_0 has a gradient too"},
    ),
    operation_exercise(
        "sigmoid",
        "σ(x) = (1 + tanh(x / 2)) / 2 never overflows; its slope can be written with its value, "
        "as that of tanh",
        hints={"large inputs": "at ±1000 the slope is 0, and never NaN"},
    ),
    operation_exercise(
        "gru_step",
        "forward, line by line, keeping r, z, n and s_n. Backward, the same lines from the last to "
        "the first: for each line, which variables are on its right-hand side?",
        hints={
            "value": "the gates are in the columns in the order reset, update, new; r multiplies "
            "the term from the state, c_n included",
            "gradient for h": "h has four paths to h': directly through z ∘ h, and through each of "
            "s_r, s_z and s_n. Add them",
            "gradient for u": "the new state depends on s_n through r, so dU gets da_n ∘ r there "
            "and not da_n",
            "gradient for c": "c is added to h · U: it gets the gradient of s",
            "gradient for x": "x · W is added to b: both get the gradient of a",
        },
        given=("linear", "mean_squared_error", "tanh"),
    ),
    operation_exercise(
        "gru",
        "a list of the steps' pullbacks; from the last frame to the first, the gradient at h_t is "
        "dy[:, t] plus the gradient that the later step returned for its h",
        hints={
            "gradient for h0": "it is the gradient that the first frame's pullback returns for h",
            "gradient for w": "every step uses the same w: sum the gradients of all steps",
            "gradient for x": "a later frame depends on an earlier x only through the state: do "
            "you add the later step's gradient for h to dy before the next pullback?",
        },
    ),
    exercise(
        clip_gradients,
        "the norm is that of all arrays concatenated: the root of the sum of all squares. One "
        "factor, min(1, bound / norm), multiplies them all",
        _clip_arguments,
        {"arrays": (1, 2, 3), "rows": (1, 2)},
        _beyond_bound,
        _within_bound,
        _zero_gradients,
        hints={
            "value": "one norm over all arrays together, or the step changes its direction",
            "nothing": "0 / 0 is not a number",
        },
    ),
)
