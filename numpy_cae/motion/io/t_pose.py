"""Removal of the T-pose that conversions of the CMU database insert before the first frame.

It is not part of the motion: the person leaves it within a 120th of a second. So it is recognised
by its shape and by the jump after it; someone recorded in a T-pose leaves it slowly and keeps it.
"""

import numpy as np

from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import Mappings, body_positions

MIN_COSINE = np.cos(np.radians(20.0))
"""Of the angle between a limb and its direction in a T-pose."""
JUMP = 8.0
"""The first step over the median of the following steps, in radians a frame over all joints."""
_FOLLOWING = 25

# limb, from, to, and its direction in a T-pose that faces +Z
_LIMBS = (
    ("left_shoulder", "left_wrist", (1.0, 0.0, 0.0)),
    ("right_shoulder", "right_wrist", (-1.0, 0.0, 0.0)),
    ("left_hip", "left_ankle", (0.0, -1.0, 0.0)),
    ("right_hip", "right_ankle", (0.0, -1.0, 0.0)),
)


def without_t_pose(motion: Motion, mapping: Mappings = None) -> Motion:
    """The motion without its first frame if that is a T-pose from which the second jumps.

    Parameters
    ----------
    motion : Motion
        At the rate of its file: resampling would blend the T-pose with the next frames.
    mapping : dict, optional
        See `find_joints`.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    if len(motion) < 3 or not _is_t_pose(motion, mapping) or not _jumps(motion):
        return motion
    return motion.at(slice(1, None))


def _is_t_pose(motion: Motion, mapping: Mappings) -> bool:
    """Whether the first frame is a T-pose."""
    body = body_positions(motion.at(slice(0, 1)), mapping)[0]
    for start, end, direction in _LIMBS:
        limb = body[JOINTS.index(end)] - body[JOINTS.index(start)]
        if limb @ np.array(direction) < MIN_COSINE * np.linalg.norm(limb):
            return False
    return True


def _jumps(motion: Motion) -> bool:
    quaternions = motion.rotations[: _FOLLOWING + 2]
    quaternions = quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True)
    # The angle between two rotations is twice that between their quaternions, of either sign.
    cosines = np.abs(np.sum(quaternions[1:] * quaternions[:-1], axis=-1))
    steps = np.linalg.norm(2 * np.arccos(np.clip(cosines, 0.0, 1.0)), axis=-1)
    return bool(steps[0] > JUMP * max(float(np.median(steps[1:])), 1e-3))
