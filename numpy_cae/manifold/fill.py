"""Filling in missing joints and poses (holden2015, section 7, "Filling in Missing Data"), in
features and in motions of any rig.

The paper projects a motion whose missing values are zero. Here the missing values are known, so the
motion starts as an interpolation of what is known. It is projected, Φ†(Φ(X)), and the difference
from the motion on both sides of a hole is interpolated over the hole, so that there is no jump:

    X_0 = spline of X,    X_{n+1} = P(X_n) + spline of (X - P(X_n)),    P the mean over all shifts

In holes of a few frames the result is a mean of this and the spline. Only unknown values are taken
from it; known values stay the same to the bit.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.manifold.holes import at_thirty, hole_lengths, spline
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.repaired import Repaired, change_joints
from numpy_cae.motion.features import POSITIONS, RootTransform, positions_to_features
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import change_lengths
from numpy_cae.motion.motion import RATE, Motion, rotations_at
from numpy_cae.motion.retarget.body import Body

REPEATS, LONG = 3, 30
"""Projections of a joint of the legs in a hole of `LONG` frames or more; others are projected once.
Chosen on sources left out of training (docs/lab_book/filling.md)."""
SHORT = 16
"""Frames of a hole from which on the spline, which is better in the shortest holes, has no weight.
Chosen likewise."""
_LEGS = range(JOINTS.index("left_hip"), len(JOINTS))


def fill(
    manifold: MotionManifold, features: np.ndarray, missing: np.ndarray, repeats: int = REPEATS
) -> np.ndarray:
    """Fill in the joints of a motion that are missing.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton. Positions of missing joints are ignored; velocity and turn are kept.
    missing : (F, 20) array of bool
        A joint that is missing in all frames starts where it is in the mean pose.
    repeats : int
        Number of projections of long holes in the legs. With 0 it is the spline alone.

    Returns
    -------
    (F, 63) array of float64
        Only the missing joints differ from `features`.

    Raises
    ------
    ValueError
        If `missing` has another shape.
    """
    missing = _checked(missing, len(features))
    filled = np.array(features, dtype=np.float64)
    points = filled[:, POSITIONS].reshape(-1, len(JOINTS), 3)  # a view
    never = np.asarray(missing.all(axis=0))
    points[:, never] = manifold.mean_pose[POSITIONS].reshape(-1, 3)[never]
    points[...] = spline(points, missing)
    if repeats == 0 or not missing.any():
        return filled
    start, lengths = points[missing], hole_lengths(missing)
    again = missing & (lengths >= LONG) & np.isin(np.arange(len(JOINTS)), _LEGS)
    for unknown in [missing, *[again] * (repeats - 1 if again.any() else 0)]:
        projected = manifold.project(filled, manifold.shifts)[:, POSITIONS].reshape(points.shape)
        error = np.where(never[:, None], 0.0, points - projected)
        points[unknown] = (projected + spline(error, missing))[unknown]
    share = np.minimum(1.0, 0.2 + 0.8 * lengths[missing] / SHORT)[:, None]
    points[missing] = start + share * (points[missing] - start)
    return filled


def fill_motion(
    motion: Motion,
    manifold: MotionManifold,
    missing: np.ndarray,
) -> Repaired:
    """Fill in the joints of a motion that are missing, ignoring where the file has them.

    All bone lengths are kept. A joint within a limb, such as an elbow whose wrist is known, can
    only be on a circle about the line between its neighbours and is moved to the point of it
    nearest to the filled position. Where the whole pose is missing, the root moves along a smooth
    curve, and rotations that positions do not determine (about a bone's axis, of fingers) are
    interpolated.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    manifold : MotionManifold
    missing : (frames, 20) array of bool
        In the frames of the file; `keyframe_mask` makes that of keyframes.

    Returns
    -------
    Repaired

    Raises
    ------
    UnknownRigError, ValueError
        If joints of the rig are missing; if the mask has another shape.
    """
    missing = _checked(missing, len(motion))
    whole = np.asarray(missing.all(axis=1))
    body = manifold.body(_interpolated(motion, whole))
    target = fill_positions(manifold, body, at_thirty(motion, missing))
    return change_joints(body, motion, target, missing)


def keyframe_mask(frames: int, every: int) -> np.ndarray:
    """What is missing where every n-th frame, from the first on, is a keyframe: (frames, 20) bool.

    Frames after the last keyframe are not missing: they stay as they are in the file.
    """
    if every < 1:
        raise ValueError(f"keyframes every {every} frames, expected 1 or more")
    frame = np.arange(frames)
    between = (frame % every > 0) & (frame < (frames - 1) // every * every)
    return np.repeat(between[:, None], len(JOINTS), axis=1)


def fill_positions(manifold: MotionManifold, body: Body, missing: np.ndarray) -> np.ndarray:
    """World positions at 30 frames a second with the joints of the mask (F, 20) filled in:
    (F, 20, 3) in metres on the motion's own bones."""
    features, root = whole_features(body, missing)
    filled = fill(manifold, features, missing)
    return np.where(missing[..., None], body.positions_of(filled, root), body.positions)


def whole_features(body: Body, missing: np.ndarray) -> tuple[np.ndarray, RootTransform]:
    """The features of a motion and its root transform, missing joints on a spline in the world, so
    that they do not distort the heading and the path of the hips."""
    start = spline(body.positions, missing)
    start = change_lengths(start, body.lengths, body.mean_lengths)
    return positions_to_features(start, RATE)


def _checked(missing: np.ndarray, frames: int) -> np.ndarray:
    if np.shape(missing) != (frames, len(JOINTS)):
        raise ValueError(f"missing has shape {np.shape(missing)}, expected ({frames}, 20)")
    return np.asarray(missing, dtype=bool)


def _interpolated(motion: Motion, gaps: np.ndarray) -> Motion:
    """The motion with rotations interpolated by slerp in the frames of `gaps`, and translations by
    `spline`."""
    known = np.flatnonzero(~gaps)
    if not gaps.any() or not len(known):
        return motion
    rotations = motion.rotations.copy()
    rotations[gaps] = rotations_at(known, rotations[known], np.flatnonzero(gaps))
    every = np.repeat(gaps[:, None], rotations.shape[1], axis=1)
    return replace(motion, rotations=rotations, translations=spline(motion.translations, every))
