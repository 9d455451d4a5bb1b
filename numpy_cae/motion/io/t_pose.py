"""The T-pose that conversions of the CMU database put before the first frame.

It is no motion: the person snaps out of it within a 120th of a second. So it is recognised by
both, by what it looks like and by the snap; someone who was recorded in a T-pose leaves it slowly
and keeps it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import body_positions

STRAIGHT = np.cos(np.radians(20.0))
"""Of the angle between a limb and where a T has it: less than that is no T-pose."""
SNAP = 8.0
"""How many times faster than the frames that follow, in radians a frame over all joints."""
_FOLLOWING = 25

# limb, from, to, and the direction that a T-pose which faces +Z has there
_LIMBS = (
    ("left_shoulder", "left_wrist", (1.0, 0.0, 0.0)),
    ("right_shoulder", "right_wrist", (-1.0, 0.0, 0.0)),
    ("left_hip", "left_ankle", (0.0, -1.0, 0.0)),
    ("right_hip", "right_ankle", (0.0, -1.0, 0.0)),
)


def without_t_pose(motion: Motion, mapping: dict[str, str] | None = None) -> Motion:
    """The motion without its first frame if that is a T-pose that the second snaps out of.

    Parameters
    ----------
    motion : Motion
        At the rate of its file: resampling would smear the T-pose into what follows.
    mapping : dict, optional
        As `find_joints` takes it.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    if len(motion) < 3 or not _looks_like_t(_first_frame(motion), mapping) or not _snaps(motion):
        return motion
    return replace(motion, rotations=motion.rotations[1:], translations=motion.translations[1:])


def _first_frame(motion: Motion) -> Motion:
    return replace(motion, rotations=motion.rotations[:1], translations=motion.translations[:1])


def _looks_like_t(motion: Motion, mapping: dict[str, str] | None) -> bool:
    body = body_positions(motion, mapping)[0]
    for start, end, direction in _LIMBS:
        limb = body[JOINTS.index(end)] - body[JOINTS.index(start)]
        if limb @ np.array(direction) < STRAIGHT * np.linalg.norm(limb):
            return False
    return True


def _snaps(motion: Motion) -> bool:
    turned = Rotation.from_quat(motion.rotations[: _FOLLOWING + 2].reshape(-1, 4))
    turned = turned.as_quat().reshape(-1, *motion.rotations.shape[1:])
    # The angle between two quaternions is twice that between them as vectors of four, either sign.
    cosines = np.abs(np.sum(turned[1:] * turned[:-1], axis=-1))
    steps = np.linalg.norm(2 * np.arccos(np.clip(cosines, 0.0, 1.0)), axis=-1)
    return bool(steps[0] > SNAP * max(np.median(steps[1:]), 1e-3))
