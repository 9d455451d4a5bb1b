"""Joint lengths, normalised: everyone gets the bones of the mean person.

holden2015, section 4: "We normalize the joint lengths". Each bone is stretched by one ratio for
the whole take, wanted length over the take's own, which keeps every direction and every speed of
a joint relative to its parent. The hips move by the ratio of the legs, so that a short person
takes the mean person's steps and the feet stay on the floor.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.joints import JOINTS, PARENTS

_LEGS = [
    JOINTS.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("knee", "ankle")
]
_NO_LENGTH = 1e-6  # metres; the CMU BVH files put both collars exactly on the chest


def bone_lengths(positions: np.ndarray) -> np.ndarray:
    """The mean length of the bone that ends at each of the twenty joints.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        In metres.

    Returns
    -------
    (20,) array of float64
        In metres; 0 for the hips, where no bone ends.
    """
    lengths = np.zeros(len(JOINTS))
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            bones = positions[:, joint] - positions[:, parent]
            lengths[joint] = np.linalg.norm(bones, axis=-1).mean()
    return lengths


def require_legs(path: str | Path, positions: np.ndarray) -> None:
    """Refuse a body that no bones of another length can be given to.

    Raises
    ------
    MotionFileError
        If the legs (knees and ankles) of these (F, 20, 3) positions in metres have no length.
    """
    legs = bone_lengths(positions)[_LEGS].sum()
    if not legs > _NO_LENGTH:
        raise MotionFileError(path, None, f"its legs are {legs:.2g} m long, expected a person's")


def change_lengths(positions: np.ndarray, own: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The same motion on bones of other lengths.

    Calling it again with `own` and `wanted` exchanged undoes it.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        In metres.
    own, wanted : (20,) arrays of float
        Bone lengths in metres, as `bone_lengths` gives them: of these positions, and of the
        result. A bone without a length of its own continues the bone above it.

    Returns
    -------
    (F, 20, 3) array of float64
        In metres.
    """
    changed = np.empty(positions.shape)
    changed[:, 0] = positions[:, 0] * (wanted[_LEGS].sum() / own[_LEGS].sum())
    for joint, parent in enumerate(PARENTS):
        if parent < 0:
            continue
        if own[joint] > _NO_LENGTH:
            bone = (positions[:, joint] - positions[:, parent]) * (wanted[joint] / own[joint])
        else:
            above = changed[:, parent] - changed[:, PARENTS[parent]]
            bone = above * (wanted[joint] / wanted[parent])
        changed[:, joint] = changed[:, parent] + bone
    return changed
