"""The exercises of lesson 09, memory: a GRU, backpropagation through time, and clipping."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from numpy_cae.course.exercises.exercise import (
    Claim,
    Exercise,
    exercise,
    operation_exercise,
    require_same,
    same_as,
    unaltered,
)
from numpy_cae.training import clip_norm
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.property import require_equal


@dataclass(frozen=True)
class Pulled:
    """The pullback of a recurrence that is a matrix for every frame: dh_(t-1) = dh_t · M_t."""

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


def _through_time(case: Case) -> dict[str, object]:
    rng = case.rng()
    hidden, frames = case["hidden"], case["frames"]
    return {
        "pull": Pulled(spread(rng, (frames, hidden, hidden), 1.5)),
        "dh": spread(rng, (case["batch"], hidden)),
        "frames": frames,
    }


def _gradients(case: Case, share: float) -> dict[str, object]:
    """Arrays of several shapes and a bound that is a share of their norm."""
    rng = case.rng()
    shapes = [(case["rows"], 2), (2,), (1, case["rows"])][: case["arrays"]]
    gradients = [spread(rng, shape) for shape in shapes]
    return {"gradients": gradients, "bound": share * _norm(gradients)}


def _norm(gradients) -> float:
    return float(np.sqrt(sum(entry**2 for each in gradients for entry in each.ravel())))


def _to_clip(case: Case) -> dict[str, object]:
    return _gradients(case, 0.25)


def _pair(returned, count: int):
    if not (isinstance(returned, tuple | list) and len(returned) == 2):
        raise AssertionError("it does not return two things: the clipped gradients and the norm")
    if not isinstance(returned[0], tuple | list) or len(returned[0]) != count:
        raise AssertionError(f"expected a list of {count} arrays, one for each gradient")
    return returned


def _require_clipped(function, gradients, bound: float, factor: float) -> None:
    clipped, norm = _pair(function([g.copy() for g in gradients], bound), len(gradients))
    require_same(norm, _norm(gradients), ("the norm",))
    for number, (found, g) in enumerate(zip(clipped, gradients, strict=True)):
        require_equal(f"gradient {number}", found, factor * g)


def _shortened(function, case: Case) -> None:
    _require_clipped(function, *_to_clip(case).values(), 0.25)


def _left_alone(function, case: Case) -> None:
    _require_clipped(function, *_gradients(case, 1.5).values(), 1.0)


def _nothing(function, case: Case) -> None:
    gradients = [np.zeros_like(each) for each in _to_clip(case)["gradients"]]
    with np.errstate(all="ignore"):
        _require_clipped(function, gradients, 1.0, 1.0)


def _gradients_stay(function, case: Case) -> None:
    gradients, bound = _to_clip(case).values()
    given = [each.copy() for each in gradients]
    function(given, bound)
    for number, (before, now) in enumerate(zip(gradients, given, strict=True)):
        require_equal(f"afterwards, gradient {number}", now, before, 0)


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "norms_through_time",
        "begin at the last frame with dh as it is given; before each step back, write its norm "
        "down; pull(t, dh) goes from frame t to frame t - 1",
        norms_through_time,
        _through_time,
        {"batch": (1, 2), "hidden": (1, 2, 3), "frames": (1, 2, 3, 4)},
        (
            Claim(
                "value",
                "entry t is the norm of dL/dh_t, from t = 0 to the last frame",
                same_as(norms_through_time, _through_time, ("the array of norms",)),
                3,
                "there is one norm more than there are steps: h_0 has a gradient too",
            ),
            unaltered(_through_time),
        ),
    ),
    operation_exercise(
        "sigmoid",
        "σ is tanh in disguise, σ(x) = (1 + tanh(x / 2)) / 2, which never overflows; its slope is "
        "written with its value, as that of tanh is",
        hints={"large inputs": "at ±1000 the slope is 0, a number like any other"},
    ),
    operation_exercise(
        "gru_step",
        "forward, line by line, keeping r, z, n and s_n. Backward, the same lines from the last to "
        "the first: for each line, which letters stand on its right-hand side?",
        hints={
            "value": "the gates stand in the columns in the order reset, update, new; r multiplies "
            "what comes from the state, c_n included",
            "gradient for h": "h has four paths to h': directly through z ∘ h, and through each of "
            "s_r, s_z and s_n. Add them",
            "gradient for u": "the part of the new state reaches s_n through r, so what goes into "
            "dU there is da_n ∘ r and not da_n",
            "gradient for c": "c stands beside h · U: it gets what s gets",
            "gradient for x": "x stands beside b: it gets what a gets",
        },
        given=("linear", "mean_squared_error", "tanh"),
    ),
    operation_exercise(
        "gru",
        "a list of the steps' pullbacks; from the last frame to the first, what arrives at h_t is "
        "dy[:, t] plus what the later step returned for its h",
        hints={
            "gradient for h0": "it is what the first frame's pullback returns for its h",
            "gradient for w": "every step uses the same w: add up what they say",
            "gradient for x": "a later frame hears of an earlier one only through the state: is "
            "what the later step says about h added to dy before you pull on?",
        },
    ),
    exercise(
        "clip_gradients",
        "the norm is that of all arrays laid end to end: the root of the sum of all squares. One "
        "factor, min(1, bound / norm), multiplies them all",
        clip_gradients,
        _to_clip,
        {"arrays": (1, 2, 3), "rows": (1, 2)},
        (
            Claim(
                "value",
                "beyond the bound, every array times bound / norm; and the norm as it was",
                _shortened,
                2,
                "one norm over all arrays together, or the step changes its direction",
            ),
            Claim("left alone", "within the bound, the gradients as they are", _left_alone),
            Claim("nothing", "gradients of zeros stay zeros", _nothing, 1, "0 / 0 is not a number"),
            Claim("purity", "no gradient is altered", _gradients_stay),
        ),
    ),
)
