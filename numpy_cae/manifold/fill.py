"""Filling in missing joints and poses by projection (holden2015, section 7, "Filling in Missing
Data"), in features and in motions of any rig.

A start in which only the known values are right is projected once, Φ†(Φ(X)). Only unknown values
are taken from the projection; known values stay the same to the bit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.interpolate import PchipInterpolator, make_interp_spline

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import (
    POSITIONS,
    VELOCITY,
    joint_slice,
    trajectory_of,
    velocities_along,
)
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.motion import Motion, slerp
from numpy_cae.motion.retarget.to_body import RATE
from numpy_cae.motion.retarget.to_rig import moves_alone

JointFiller = Callable[[MotionManifold, np.ndarray, str], np.ndarray]


def fill_joint(manifold: MotionManifold, features: np.ndarray, joint: str) -> np.ndarray:
    """Fill in one joint of a motion whose marker is missing.

    The unknown values are replaced by the mean pose, zero after normalisation, and projected.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton. The joint is unknown in the frames where one of its three values is
        NaN, or in all frames if there is none.
    joint : str
        One of `numpy_cae.motion.JOINTS`, such as "left_wrist".

    Returns
    -------
    (F, 63) array of float64
        Only the unknown values of the joint differ from `features`.
    """
    place = joint_slice(_require_joint(joint))
    filled = np.array(features, dtype=np.float64)
    unknown = np.isnan(filled[:, place]).any(axis=1)
    if not unknown.any():
        unknown = np.ones(len(filled), dtype=bool)
    filled[unknown, place] = manifold.mean_pose[place]
    filled[unknown, place] = manifold.project(filled)[unknown, place]
    return filled


def fill_keyframes(
    manifold: MotionManifold, features: np.ndarray, every: int, start: str = "line"
) -> np.ndarray:
    """Fill in the poses between keyframes, which are every n-th frame from the first on.

    The root moves linearly from keyframe to keyframe. The poses are projected once; the difference
    between projection and keyframes is interpolated smoothly and subtracted, so that keyframes are
    met exactly and without a jump. The pose of the last keyframe is held.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton. Poses between keyframes are ignored; of the velocity and the turn only
        the sums from keyframe to keyframe are used.
    every : int
        Frames from one keyframe to the next.
    start : {"line", "held"}
        What is projected: poses interpolated linearly between keyframes, or, as in the paper, each
        keyframe held until the next.

    Returns
    -------
    (F, 63) array of float64
    """
    if start not in ("line", "held"):
        raise ValueError(f"start is {start!r}, expected 'line' or 'held'")
    return _fill_between(manifold, features, _keyframes(len(features), every), start)


def fill_motion_joint(
    motion: Motion,
    manifold: MotionManifold,
    joint: str,
    mapping: dict[str, str] | None = None,
    frames: tuple[int, int] | None = None,
    filler: JointFiller = fill_joint,
) -> Motion:
    """Fill in one joint of a motion, ignoring where the file has it.

    The other nineteen joints and all bone lengths are kept. A joint within a limb, such as an
    elbow, can only be on a circle about the line between its neighbours and is moved to the point
    of it nearest to the filled position. Only rotations of joints whose bones change direction
    differ.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    manifold : MotionManifold
    joint : str
    mapping : dict of joint name to the rig's joint name, optional
    frames : (first, last), optional
        Frames of the file in which the joint is missing, from 0, both included; all where None.
    filler : function (manifold, features, joint) -> features
        Fills in the values of the joint that are NaN.

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length.

    Raises
    ------
    UnknownRigError, ValueError
        If joints are missing; if there are no such frames or the rig cannot move the joint alone.
    """
    place = JOINTS.index(_require_joint(joint))
    body = manifold.body(motion, mapping)
    if not moves_alone(motion, joint, mapping):
        movable = [name for name in JOINTS if moves_alone(motion, name, mapping)]
        raise ValueError(
            f"{joint} is fixed between its neighbours in this rig and cannot be filled "
            f"without moving them; {', '.join(movable)} can"
        )
    first, last = frames or (0, len(motion) - 1)
    if not 0 <= first <= last < len(motion):
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {len(motion) - 1}")
    source = motion.source_frames(RATE)
    missing = (source > first - 1) & (source < last + 1)
    filled = body.features.copy()
    if missing.any():
        filled[missing, joint_slice(joint)] = np.nan
        filled = filler(manifold, filled, joint)
    target = body.in_file_frames(body.positions_of(filled)[:, [place]])[:, 0]
    positions = body.positions_in_file.copy()
    children = [child for child in range(len(JOINTS)) if PARENTS[child] == place]
    if children:
        parent, child = positions[:, PARENTS[place]], positions[:, children[0]]
        target = _nearest_on_circle(target, positions[:, place], parent, child)
    positions[first : last + 1, place] = target[first : last + 1]
    return body.retarget(positions)


def fill_motion_keyframes(
    motion: Motion, manifold: MotionManifold, every: int, mapping: dict[str, str] | None = None
) -> Motion:
    """Fill in the poses between keyframes of a motion, ignoring what the file has there.

    Frames 0, n, 2n, … of the file are kept to the bit. Rotations that positions do not determine
    (about a bone's axis, of fingers) are interpolated by slerp from keyframe to keyframe. The pose
    of the last keyframe is held.

    Arguments, result and errors are as in `fill_motion_joint`; `every` is in frames of the file.
    """
    keys = _keyframes(len(motion), every)
    body = manifold.body(_interpolated(motion, keys), mapping)
    source = motion.source_frames(RATE)
    nearest = np.unique([np.abs(source - key).argmin() for key in keys])
    filled = body.positions_of(_fill_between(manifold, body.features, nearest, "line"))
    positions = body.in_file_frames(filled)
    known = body.positions_in_file[keys]
    positions += _interpolate(known - positions[keys], keys, len(motion), True)
    positions[keys] = known
    return body.retarget(positions)


def _require_joint(joint: str) -> str:
    if joint not in JOINTS:
        raise ValueError(f"there is no joint {joint!r}, expected one of {', '.join(JOINTS)}")
    return joint


def _keyframes(frames: int, every: int) -> np.ndarray:
    if every < 1:
        raise ValueError(f"keyframes every {every} frames, expected 1 or more")
    return np.arange(0, frames, every)


def _fill_between(
    manifold: MotionManifold, features: np.ndarray, keys: np.ndarray, start: str
) -> np.ndarray:
    """`fill_keyframes` for keyframes at any frames: (K,) int, increasing from 0."""
    features = np.asarray(features, dtype=np.float64)
    floor, theta = trajectory_of(features)
    frames = len(features)
    filled = np.empty(features.shape)
    filled[:, VELOCITY.start :] = velocities_along(
        _interpolate(floor[keys], keys, frames), _interpolate(theta[keys], keys, frames)
    )
    poses = features[keys, POSITIONS]
    if start == "line":
        filled[:, POSITIONS] = _interpolate(poses, keys, frames)
    else:
        filled[:, POSITIONS] = poses[np.searchsorted(keys, np.arange(frames), side="right") - 1]
    filled[:, POSITIONS] = manifold.project(filled)[:, POSITIONS]
    filled[:, POSITIONS] += _interpolate(poses - filled[keys, POSITIONS], keys, frames, True)
    filled[keys, POSITIONS] = poses
    return filled


def _interpolate(
    values: np.ndarray, keys: np.ndarray, frames: int, smooth: bool = False
) -> np.ndarray:
    """Values (K, …) at the frames `keys`, interpolated linearly or by a monotone cubic, which does
    not overshoot; the last is held."""
    if len(keys) == 1:
        return np.repeat(values, frames, axis=0)
    curve = PchipInterpolator(keys, values) if smooth else make_interp_spline(keys, values, k=1)
    return curve(np.minimum(np.arange(frames), keys[-1]))


def _nearest_on_circle(
    target: np.ndarray, own: np.ndarray, parent: np.ndarray, child: np.ndarray
) -> np.ndarray:
    """The point nearest to `target` on the circle through `own` about the line from parent to
    child, where the distances from both are kept. All arrays are (F, 3)."""
    line = child - parent
    line = line / np.maximum(np.linalg.norm(line, axis=-1, keepdims=True), 1e-12)

    def off_line(points: np.ndarray) -> np.ndarray:
        along = np.sum((points - parent) * line, axis=-1, keepdims=True) * line
        return points - parent - along

    radius = np.linalg.norm(off_line(own), axis=-1, keepdims=True)
    outward = off_line(target)
    distance = np.linalg.norm(outward, axis=-1, keepdims=True)
    on_circle = outward / np.maximum(distance, 1e-12) * radius
    return own - off_line(own) + np.where(distance > 1e-6, on_circle, off_line(own))


def _interpolated(motion: Motion, keys: np.ndarray) -> Motion:
    """Keyframes with rotations interpolated by slerp between them, and translations linearly."""
    rotations = slerp(keys, motion.rotations[keys], np.arange(len(motion)))
    rotations[keys] = motion.rotations[keys]
    translations = _interpolate(motion.translations[keys], keys, len(motion))
    translations[keys] = motion.translations[keys]
    return replace(motion, rotations=rotations, translations=translations)
