"""Removal of jitter from a whole motion (`repair.filters`).

A filter smears single frames that jump, so these are filtered strongly after it, from the values
before it (`repair.jumps`).
"""

from collections.abc import Sequence

from numpy_cae.motion.motion import Motion
from numpy_cae.repair.filters import filter_motion, smooth_curve
from numpy_cae.repair.finding import BODY, Finding
from numpy_cae.repair.jumps import jumping_steps, without_jumps


def find_jitter(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """One finding about the whole motion, of kind "jitter"."""
    return [Finding(BODY, (0, len(motion) - 1), "jitter", "the whole motion is smoothed")]


def smooth_motion(motion: Motion, findings: Sequence[Finding] = ()) -> Motion:
    """The motion without the jitter of its rotations and translations, in all frames."""
    smooth = filter_motion(motion, lambda curve: smooth_curve(curve, motion.rate))
    return without_jumps(smooth, jumping_steps(smooth), motion)
