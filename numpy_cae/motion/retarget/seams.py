"""Rotations that continue the frames around a stretch of damaged ones.

Positions leave the rotation of a bone about its own axis undetermined, and retargeting keeps it
from the motion. Where that motion is damaged it would jump at both ends of the stretch. So before
retargeting the rotations of a short stretch are interpolated by slerp; in a longer one, the
rotations that are missing at its first and at its last frame are interpolated and applied,

    R'_t = R_t · exp((1 - s) log D_first + s log D_last),    D = R⁻¹ · (R continued from outside)

which keeps the detail in between and restores a joint that is off by a constant rotation or frozen.
"""

import numpy as np

from numpy_cae.motion.masks import runs
from numpy_cae.motion.quaternions import from_vector, inverse, product, slerp, to_vector

SHORT = 0.25
"""SHORT: a damaged stretch of at most so many seconds is interpolated, with any spike in it."""


def without_seams(rotations: np.ndarray, damaged: np.ndarray, rate: float) -> np.ndarray:
    """The rotations (F, 4) of one joint as quaternions, changed only where `damaged` (F)."""
    changed = rotations.copy()
    for first, end in runs(damaged):
        inside = rotations[first:end]
        before, after = _continued(rotations[:first][-2:]), _continued(rotations[end:][1::-1])
        ends = ((inside[0], before), (inside[-1], after))
        missing = [to_vector(product(inverse(now), out)) for now, out in ends if out is not None]
        if len(missing) == 2 and end - first <= SHORT * rate:
            share = np.arange(1, end - first + 1) / (end - first + 1)
            changed[first:end] = slerp(rotations[first - 1], rotations[end], share)
        elif missing:
            share = np.linspace(0, 1, end - first)[:, None]
            applied = from_vector((1 - share) * missing[0] + share * missing[-1])
            changed[first:end] = product(inside, applied)
    return changed


def _continued(last: np.ndarray) -> np.ndarray | None:
    """The rotation that follows the last two, (up to 2, 4); None if there are none."""
    if len(last) == 0:
        return None
    return product(product(last[-1], inverse(last[0])), last[-1])
