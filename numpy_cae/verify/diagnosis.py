"""What a wrong gradient looks like, and the mistake that usually looks that way.

Two kinds of evidence: the pattern in the numbers (the pullback's gradient against the one by
differences: turned around, transposed, shifted, a constant factor apart), and experiments on the
pullback itself (does it notice when all but one window of the upstream gradient is zeroed? does it
become right when the filters are flipped?).
"""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.point import Point, gradient_by_differences
from numpy_cae.verify.suspects import SUSPECTS, dropped

DIFFERENCES_UP_TO = 300
COARSE = "the value is computed in float32, too coarse for its slope to be measured"


def likely_mistake(at: Point) -> str | None:
    """A sentence for the mistake that the wrong gradient at a point shows, or None."""
    if _is_coarse(at):
        return COARSE
    if at.x.size > DIFFERENCES_UP_TO:
        return None
    numeric = gradient_by_differences(at)
    if not np.any(at.gradient):
        return dropped(at)
    for suspect in SUSPECTS:
        sentence = suspect(at, numeric)
        if sentence:
            return sentence
    return None


def mistake_in_shape(at: Point) -> str | None:
    """A sentence for a gradient of the wrong shape, or None."""
    have, want = np.shape(at.gradient), at.x.shape
    if at.gradient is None:
        return "this argument's gradient was never computed"
    if have == want[::-1] or sorted(have) == sorted(want):
        return "a transpose: the axes are those of the argument in another order"
    if len(have) > len(want) and have[len(have) - len(want) :] == want:
        summed = have[: len(have) - len(want)]
        if at.dy.shape[: len(summed)] == summed:
            return "a missing sum over " + " and ".join(("the batch", "time")[: len(summed)])
        if len(summed) == 1 and at.dy.ndim > 1 and summed[0] == at.dy.shape[1]:
            return "a missing sum over time"
        return "a missing sum over the leading axes"
    return None


def mistake_in_error(error: Exception) -> str | None:
    """A sentence for an exception out of someone's implementation, or None."""
    text = str(error)
    if "mismatch in its core dimension" in text or "not aligned" in text:
        return "a transpose: the shapes of a matrix product do not fit"
    if "could not be broadcast" in text:
        return "the axes: an array has another shape than its destination"
    return None


def mistake_in_roughness(at: Point) -> str | None:
    """A sentence for a value whose slope settles nowhere, or None."""
    if _is_coarse(at):
        return COARSE
    return "the input sits on ties; or the value does not follow the input smoothly"


def _is_coarse(at: Point) -> bool:
    """Whether the value moves in float32's steps when the argument moves in smaller ones."""
    nearby = at.moved_to(at.x * (1 + 1e-10) + 1e-10)
    return bool(np.any(nearby % 0.0625)) and np.array_equal(nearby, nearby.astype(np.float32))
