"""Normalisation of bone lengths: every body gets the mean bones of all.

holden2015, section 4: "We normalize the joint lengths". Each bone is scaled by one ratio for the
whole take, target length over own length, which keeps its direction. The hips move by the ratio
of the legs, so that a short person takes the mean person's steps and the feet stay on the floor.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.motion.features import positions_to_features
from numpy_cae.motion.joints import JOINTS, PARENTS

_LEGS = [
    JOINTS.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("knee", "ankle")
]
_NO_LENGTH = 1e-6
"""_NO_LENGTH: a bone shorter than this (m) has no direction. In the CMU BVH files both collars are
exactly at the chest."""
LEGS = (0.05, 20.0)
"""LEGS: a person's two legs together, thighs and shins, are between these lengths (m); an adult's
are about 1.7."""


def bone_lengths(positions: np.ndarray) -> np.ndarray:
    """The mean length of the bone that ends at each of the twenty joints.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions of the twenty joints in metres.

    Returns
    -------
    (20,) array of float64
        Metres; 0 for the hips, where no bone ends.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_of
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> float(bone_lengths(walk)[JOINTS.index("left_knee")].round(2))  # the thigh
    0.44
    """
    return frame_lengths(positions).mean(axis=0)


def frame_lengths(positions: np.ndarray) -> np.ndarray:
    """The lengths in each frame, (F, 20)."""
    lengths = np.linalg.norm(positions - positions[:, PARENTS], axis=-1)
    lengths[:, 0] = 0.0  # no bone ends at the hips
    return lengths


def problem_of(positions: np.ndarray) -> str:
    """Why positions (F, 20, 3) in metres are not those of a person whose bones `change_lengths` can
    scale; empty if they are. A bone of length 0 is allowed only below a bone of
    positive length."""
    if not np.isfinite(positions).all():
        return "some frames have values that are not numbers; `numpy-cae repair` fills them in"
    # A few damaged frames do not change the median.
    return problem_of_lengths(np.median(frame_lengths(positions), axis=0))


def problem_of_lengths(lengths: np.ndarray) -> str:
    """The same of bone lengths (20,) in metres."""
    legs = lengths[_LEGS].sum()
    if not LEGS[0] <= legs <= LEGS[1]:
        problem = f"the bones to both knees and ankles are {legs:.3g} m long in all"
        return f"{problem}, expected {LEGS[0]:g} to {LEGS[1]:g} m; is the unit another?"
    for joint, parent in list(enumerate(PARENTS))[1:]:
        if lengths[joint] <= _NO_LENGTH and (parent == 0 or lengths[parent] <= _NO_LENGTH):
            return f"the bone to {JOINTS[joint]} has no length: the joint is at {JOINTS[parent]}"
    return ""


def change_lengths(positions: np.ndarray, own: np.ndarray, target: np.ndarray) -> np.ndarray:
    """The same motion on bones of other lengths; `own` and `target` exchanged give the inverse.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    own, target : (20,) arrays of float
        Bone lengths in metres, as `bone_lengths` returns them: of these positions, and of the
        result. A bone of length 0 in `own` has no direction:
        in the result it gets that of the bone above it.

    Returns
    -------
    (F, 20, 3) array of float64
        World positions in metres.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_of
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> lengths = bone_lengths(walk)
    >>> taller = change_lengths(walk, lengths, 1.1 * lengths)
    >>> bool(np.allclose(bone_lengths(taller), 1.1 * lengths))
    True
    """
    changed = np.empty(positions.shape)
    changed[:, 0] = positions[:, 0] * (target[_LEGS].sum() / own[_LEGS].sum())
    for joint, parent in list(enumerate(PARENTS))[1:]:
        if own[joint] > _NO_LENGTH:
            bone = (positions[:, joint] - positions[:, parent]) * (target[joint] / own[joint])
        else:
            above = changed[:, parent] - changed[:, PARENTS[parent]]
            longer = target[parent] > _NO_LENGTH
            bone = above * (target[joint] / target[parent] if longer else 0.0)
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
    lengths_of_takes = [bone_lengths(take) for take in takes]
    mean = np.mean(lengths_of_takes, axis=0)
    features = [
        positions_to_features(change_lengths(take, lengths, mean), rate)[0]
        for take, lengths in zip(takes, lengths_of_takes, strict=True)
    ]
    return features, mean
