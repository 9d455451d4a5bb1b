"""Make the rotations in a stretch of damaged frames continue those of the frames around it.

Positions do not determine the rotation of a bone about its own axis, so retargeting takes it over
from the original motion. Where that motion is damaged, this rotation would jump at both ends of the
stretch. Therefore rotations are changed before retargeting. In a short stretch they are
interpolated by slerp. In a longer one, D_first and D_last are the corrections that would join its
first and its last frame to the frames outside, and s runs from 0 to 1 over the stretch:

    R'_t = R_t · exp((1 - s) log D_first + s log D_last),    D = R⁻¹ · (R continued from outside)

This keeps the details in between, and it restores a joint that is frozen or off by a constant
rotation.
"""

import numpy as np

from numpy_cae.motion.masks import runs
from numpy_cae.motion.quaternions import from_vector, inverse, product, slerp, to_vector

SHORT = 0.25
"""SHORT: a damaged stretch of at most this duration (s) is interpolated, including its spikes."""


def without_seams(rotations: np.ndarray, damaged: np.ndarray, rate: float) -> np.ndarray:
    """The rotations (F, 4) of one joint as quaternions, changed only where `damaged` (F)."""
    changed = rotations.copy()
    for first, end in runs(damaged):
        inside = rotations[first:end]
        # [1::-1]: the first two frames after the stretch, in reverse order.
        before, after = _continued(rotations[:first][-2:]), _continued(rotations[end:][1::-1])
        ends = ((inside[0], before), (inside[-1], after))
        corrections = [to_vector(product(inverse(now), to)) for now, to in ends if to is not None]
        if len(corrections) == 2 and end - first <= SHORT * rate:
            share = np.arange(1, end - first + 1) / (end - first + 1)
            changed[first:end] = slerp(rotations[first - 1], rotations[end], share)
        elif corrections:
            share = np.linspace(0, 1, end - first)[:, None]
            applied = from_vector((1 - share) * corrections[0] + share * corrections[-1])
            changed[first:end] = product(inside, applied)
    return changed


def _continued(last: np.ndarray) -> np.ndarray | None:
    """The rotation that continues the `last` one or two, (1 or 2, 4); None if there are none."""
    if len(last) == 0:
        return None
    return product(product(last[-1], inverse(last[0])), last[-1])
