"""Normalisation of bone lengths: every body gets the mean bones of all.

holden2015, section 4: "We normalize the joint lengths". Each bone is scaled by one ratio for the
whole take, target length over own length, which keeps its direction. The hips move by the ratio
of the legs, so that a short person takes the mean person's steps and the feet stay on the floor.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.motion.features import positions_to_features
from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.joints import JOINTS, PARENTS

_LEGS = [
    JOINTS.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("knee", "ankle")
]
_NO_LENGTH = 1e-6  # metres; the CMU BVH files have both collars exactly at the chest


def bone_lengths(positions: np.ndarray) -> np.ndarray:
    """The mean length of the bone that ends at each of the twenty joints, (20,) in metres, from
    positions (F, 20, 3) in metres. It is 0 for the hips, where no bone ends.
    """
    lengths = np.zeros(len(JOINTS))
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            bones = positions[:, joint] - positions[:, parent]
            lengths[joint] = np.linalg.norm(bones, axis=-1).mean()
    return lengths


def require_legs(path: str | Path, positions: np.ndarray) -> None:
    """Raise MotionFileError if the legs in (F, 20, 3) positions have no length, so that
    `change_lengths` cannot scale the body."""
    legs = bone_lengths(positions)[_LEGS].sum()
    if not legs > _NO_LENGTH:
        raise MotionFileError(path, None, f"its legs are {legs:.2g} m long, expected a person's")


def change_lengths(positions: np.ndarray, own: np.ndarray, target: np.ndarray) -> np.ndarray:
    """The same motion on bones of other lengths.

    With `own` and `target` exchanged it is its own inverse.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        In metres.
    own, target : (20,) arrays of float
        Bone lengths in metres, as `bone_lengths` returns them: of these positions, and of the
        result. A bone without a length of its own continues the bone above it.

    Returns
    -------
    (F, 20, 3) array of float64
        In metres.
    """
    changed = np.empty(positions.shape)
    changed[:, 0] = positions[:, 0] * (target[_LEGS].sum() / own[_LEGS].sum())
    for joint, parent in list(enumerate(PARENTS))[1:]:
        if own[joint] > _NO_LENGTH:
            bone = (positions[:, joint] - positions[:, parent]) * (target[joint] / own[joint])
        else:
            above = changed[:, parent] - changed[:, PARENTS[parent]]
            bone = above * (target[joint] / target[parent])
        changed[:, joint] = changed[:, parent] + bone
    return changed


def features_on_mean_skeleton(
    takes: Sequence[np.ndarray], rate: float
) -> tuple[list[np.ndarray], np.ndarray]:
    """The features of each take on the mean bones of all takes.

    Parameters
    ----------
    takes : sequence of (F, 20, 3) arrays of float
        World positions of the twenty joints in metres.
    rate : float
        Frames a second.

    Returns
    -------
    features : list of (F, 63) arrays of float64
    lengths : (20,) array of float64
        The mean bone lengths in metres; each take has the same weight.
    """
    own = [bone_lengths(take) for take in takes]
    mean = np.mean(own, axis=0)
    features = [
        positions_to_features(change_lengths(take, lengths, mean), rate)[0]
        for take, lengths in zip(takes, own, strict=True)
    ]
    return features, mean
