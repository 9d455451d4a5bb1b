"""Removal of the T-pose that conversions of the CMU database insert before the first frame.

It is not part of the motion: the person leaves it within a 120th of a second. So it is recognised
by its shape and by the jump after it; someone recorded in a T-pose leaves it slowly and keeps it.
"""

import numpy as np

from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import angle, inverse, product
from numpy_cae.motion.retarget.rigs import body_positions

MIN_COSINE = np.cos(np.radians(20.0))
"""MIN_COSINE: a limb is in a T-pose if the angle to its direction there has this cosine or more."""
JUMP = 8.0
"""JUMP: the first step counts as a jump if it is so many times the median of those that follow."""
_FOLLOWING = 25

# limb, from, to, and its direction in a T-pose that faces +Z
_LIMBS = (
    ("left_shoulder", "left_wrist", (1.0, 0.0, 0.0)),
    ("right_shoulder", "right_wrist", (-1.0, 0.0, 0.0)),
    ("left_hip", "left_ankle", (0.0, -1.0, 0.0)),
    ("right_hip", "right_ankle", (0.0, -1.0, 0.0)),
)


def without_t_pose(motion: Motion) -> Motion:
    """The motion without its first frame if that is a T-pose from which the second jumps.

    Parameters
    ----------
    motion : Motion
        At the rate of its file: resampling would blend the T-pose with the next frames.

    Returns
    -------
    Motion
        The same object if its first frame is no such T-pose.

    Raises
    ------
    UnknownRigError
        If joints are missing.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 1, seconds=1.0).motion
    >>> without_t_pose(walk) is walk
    True
    """
    if len(motion) < 3:
        return motion
    body = body_positions(motion.at(slice(0, 1)))[0]
    for start, end, direction in _LIMBS:
        limb = body[JOINTS.index(end)] - body[JOINTS.index(start)]
        if limb @ np.array(direction) < MIN_COSINE * np.linalg.norm(limb):
            return motion
    first = motion.rotations[: _FOLLOWING + 2]
    steps = np.linalg.norm(angle(product(first[1:], inverse(first[:-1]))), axis=-1)
    jumps = steps[0] > JUMP * max(float(np.median(steps[1:])), 1e-3)
    return motion.at(slice(1, None)) if jumps else motion
