"""Filling in missing joints and poses (holden2015, section 7, "Filling in Missing Data").

`fill` has only features, without a rig, and is `MotionManifold.complete` for joints. `fill_motion`
and `repair` have a motion in a rig: X_0 is the motion whose unknown rotations are on curves
(`cleanup.interpolation`), and `complete_from_curves` returns X_0 + s (X_N - X_0) for each joint and
hole, by the same iteration (`completion.complete`). `cleanup.holes` chooses the curves and s in the
known frames of the same motion. There the interpolation I is a curve with the speed of the motion
at both ends of the hole. Arrays are at thirty frames a second, (F, …).
"""

import numpy as np

from numpy_cae.manifold.completion import complete
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion import JOINTS, PARENTS, RATE
from numpy_cae.motion.features import POSITIONS, local_positions
from numpy_cae.motion.hole_curves import interpolate_values
from numpy_cae.motion.masks import runs_with

LEG_PROJECTIONS = 4
"""After a first projection of all joints, `complete_from_curves` projects legs this many times.
Chosen on sources left out of training (docs/lab_book/filling.md)."""
_ARMS = range(JOINTS.index("left_collar"), JOINTS.index("left_hip"))
_LEGS = range(JOINTS.index("left_hip"), len(JOINTS))
_ENDS = [joint for joint in range(len(JOINTS)) if joint not in PARENTS]


def fill(manifold: MotionManifold, features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Fill in the joints of a motion that are missing.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton, at thirty frames a second. Positions of missing joints are ignored;
        velocity and turn are kept.
    missing : (F, 20) array of bool
        A joint that is missing in all frames starts where it is in the mean pose.

    Returns
    -------
    (F, 63) array of float64
        Only the missing joints differ from `features`.

    Raises
    ------
    ValueError
        If `missing` has another shape.

    Examples
    --------
    The mean error in metres of an ankle that is missing for a second:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> from numpy_cae.mocap import body_of
    >>> manifold = starter()
    >>> walk = body_of(make_take("walk", 0, seconds=4.0, rate=30.0).motion)
    >>> features, _ = manifold.features(walk)
    >>> missing = np.zeros((120, 20), bool)
    >>> missing[30:60, JOINTS.index("left_ankle")] = True
    >>> gap = (fill(manifold, features, missing) - features)[:, POSITIONS]
    >>> print(np.linalg.norm(gap.reshape(-1, 20, 3), axis=-1)[missing].mean().round(3))
    0.008
    """
    missing = require_mask(missing, len(features))
    known = np.ones(features.shape, dtype=bool)
    known[:, POSITIONS] = ~np.repeat(missing, 3, axis=1)
    return manifold.complete(features, known)


def complete_from_curves(
    manifold: MotionManifold, features: np.ndarray, missing: np.ndarray, strength: np.ndarray
) -> np.ndarray:
    """Complete a motion whose missing joints start on the rotation curves of its rig.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        X_0, on the mean skeleton: missing joints are where `interpolate_joints` puts them. A joint
        that is missing in all frames starts where it is in the mean pose.
    missing : (F, 20) array of bool
    strength : (F, 20) array of float
        s of the module's equation; 1 is taken for joints that are missing in all frames.

    Returns
    -------
    (F, 63) array of float64
        Only the missing joints differ from `features`.
    """
    features = np.array(features, dtype=np.float64)
    always_missing = np.asarray(missing.all(axis=0))
    points = local_positions(features)  # a view
    points[:, always_missing] = manifold.mean_pose[POSITIONS].reshape(-1, 3)[always_missing]
    share = np.where(always_missing, 1.0, strength) * missing
    if not share.any():
        return features

    def project(points: np.ndarray, _averaged: bool) -> np.ndarray:
        with_points = features.copy()
        local_positions(with_points)[...] = points
        return local_positions(manifold.project(with_points, average_shifts=True))

    def interpolate(values: np.ndarray, known: np.ndarray) -> np.ndarray:
        return interpolate_values(values, ~known[..., 0], RATE)

    is_leg = classify_holes(missing) == HOLE_KINDS.index("leg")
    known = ~np.repeat(missing[..., None], 3, axis=-1)
    known_but_legs = ~np.repeat(is_leg[..., None], 3, axis=-1)
    once = complete(points, known, project, interpolate, points, projections=1)
    x_n = complete(once, known_but_legs, project, interpolate, once, LEG_PROJECTIONS)
    points += share[..., None] * (x_n - points)
    return features


HOLE_KINDS = ("", "end", "arm", "leg", "pose")
"""Kinds of holes, by the number that `classify_holes` gives them. "": not missing; "end": the end
of a limb alone, such as a wrist whose elbow is known; "arm", "leg": a joint of a limb; "pose": a
joint of the trunk, and any joint of a hole in which the body's place or heading is not visible: the
hips are missing, or a joint of both pairs of hips and shoulders."""
_PAIRS = [
    [JOINTS.index(f"{side}_{joint}") for side in ("left", "right")] for joint in ("hip", "shoulder")
]


def classify_holes(missing: np.ndarray) -> np.ndarray:
    """The kind of hole in which each joint of a mask (F, 20) is: int8 (F, 20), an index of
    `HOLE_KINDS`."""
    end, arm, leg, pose = range(1, len(HOLE_KINDS))
    kinds = np.full(missing.shape, pose, dtype=np.int8)
    kinds[:, _ARMS] = arm
    kinds[:, _LEGS] = leg
    with_parent = runs_with(missing, missing[:, [0, *PARENTS[1:]]])
    kinds[:, _ENDS] = np.where(with_parent, kinds, end)[:, _ENDS]
    no_heading = missing[:, _PAIRS[0]].any(axis=1) & missing[:, _PAIRS[1]].any(axis=1)
    no_frame = np.asarray(missing[:, 0] | no_heading)
    without_frame = runs_with(missing, np.repeat(no_frame[:, None], len(JOINTS), axis=1))
    kinds[without_frame] = pose
    kinds[~missing] = 0
    return kinds


def keyframe_mask(frames: int, every: int) -> np.ndarray:
    """What is missing where every n-th frame, from the first on, is a keyframe.

    Frames after the last keyframe are not missing: they stay as they are in the file.

    Parameters
    ----------
    frames : int
        The number of frames of the file.
    every : int
        n.

    Returns
    -------
    (frames, 20) array of bool
        In the frames of the file, as `fill_motion` takes it.

    Raises
    ------
    ValueError
        If `every` is less than 1.

    Examples
    --------
    >>> keyframe_mask(8, 3)[:, 0].astype(int)
    array([0, 1, 1, 0, 1, 1, 0, 0])
    """
    if every < 1:
        raise ValueError(f"keyframes every {every} frames, expected 1 or more")
    frame = np.arange(frames)
    every = min(every, max(frames, 1))  # any number above is one keyframe, too
    between = (frame % every > 0) & (frame < (frames - 1) // every * every)
    return np.repeat(between[:, None], len(JOINTS), axis=1)


def require_mask(missing: np.ndarray, frames: int) -> np.ndarray:
    """Return the mask as an array of bool; ValueError unless it is (frames, 20)."""
    if np.shape(missing) != (frames, len(JOINTS)):
        raise ValueError(f"missing has shape {np.shape(missing)}, expected ({frames}, 20)")
    return np.asarray(missing, dtype=bool)
