"""What is missing from a motion, filled in by projection (holden2015, section 7, "Filling in
Missing Data"), on features.

Both are one plain projection Φ†(Φ(X)) of a start in which only what is known went in. Of what comes
out only the unknown is taken; what was observed stays as it was, to the bit.
"""

from __future__ import annotations

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
from numpy_cae.motion.joints import JOINTS


def require_joint(joint: str) -> str:
    """Raise ValueError, with the names that there are, unless `joint` is one of the twenty."""
    if joint not in JOINTS:
        raise ValueError(f"there is no joint {joint!r}, expected one of {', '.join(JOINTS)}")
    return joint


def fill_joint(manifold: MotionManifold, features: np.ndarray, joint: str) -> np.ndarray:
    """A motion whose marker of one joint is missing, with the joint where the manifold has it.

    The paper: "We use our technique to automatically infer the marker position of a character's
    wrist". The unknown goes in as zero, the mean pose; every other number counts as observed, the
    velocity and the turn of the body too.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton, not normalised. The joint is unknown in the frames where one of its
        three numbers is NaN; where none is, in all of them.
    joint : str
        One of `numpy_cae.motion.JOINTS`, such as "left_wrist".

    Returns
    -------
    (F, 63) array of float64
        The same to the bit but for the joint's three numbers where they were unknown.

    Raises
    ------
    ValueError
        If there is no such joint.
    """
    place = joint_slice(require_joint(joint))
    filled = np.array(features, dtype=np.float64)
    unknown = np.isnan(filled[:, place]).any(axis=1)
    if not unknown.any():
        unknown[:] = True
    filled[unknown, place] = manifold.mean_pose[place]
    filled[unknown, place] = manifold.project(filled)[unknown, place]
    return filled


def fill_keyframes(
    manifold: MotionManifold, features: np.ndarray, every: int, start: str = "line"
) -> np.ndarray:
    """A motion of which every n-th frame is known, with what the manifold has in between.

    The paper: "stepped animation data using only every 15 frames". Known of a keyframe are the
    pose and where the body stands and faces. From one to the next it goes evenly. Projected once,
    the poses miss the keyframes; what they miss them by is taken away, easing from one to
    the next: keyframes are met to the bit, without a jump. After the last one its pose is held.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton, not normalised. Poses in between may be anything; of the velocity
        and the turn only the sums from keyframe to keyframe are used.
    every : int
        Frames from one keyframe to the next; the first frame is one.
    start : {"line", "held"}
        What is projected: poses along a line from keyframe to keyframe, or, as in the paper, each
        held until the next.

    Returns
    -------
    (F, 63) array of float64

    Raises
    ------
    ValueError
        If `every` is below 1 or `start` is none of the two.
    """
    if every < 1:
        raise ValueError(f"keyframes every {every} frames, expected 1 or more")
    return fill_between(manifold, features, np.arange(0, len(features), every), start)


def fill_between(
    manifold: MotionManifold, features: np.ndarray, keys: np.ndarray, start: str = "line"
) -> np.ndarray:
    """As `fill_keyframes`, from keyframes anywhere: (K,) int, increasing from 0."""
    if start not in ("line", "held"):
        raise ValueError(f"start is {start!r}, expected 'line' or 'held'")
    features = np.asarray(features, dtype=np.float64)
    floor, theta = trajectory_of(features)
    frames = len(features)
    filled = np.empty(features.shape)
    filled[:, VELOCITY.start :] = velocities_along(
        between(floor[keys], keys, frames), between(theta[keys], keys, frames)
    )
    poses = features[keys, POSITIONS]
    if start == "line":
        filled[:, POSITIONS] = between(poses, keys, frames)
    else:
        filled[:, POSITIONS] = poses[np.searchsorted(keys, np.arange(frames), side="right") - 1]
    filled[:, POSITIONS] = manifold.project(filled)[:, POSITIONS]
    filled[:, POSITIONS] += eased(poses - filled[keys, POSITIONS], keys, frames)
    filled[keys, POSITIONS] = poses
    return filled


def between(values: np.ndarray, keys: np.ndarray, frames: int) -> np.ndarray:
    """Values (K, …) at the frames `keys`, along a line in each frame from one to the next."""
    if len(keys) == 1:
        return np.repeat(values, frames, axis=0)
    return make_interp_spline(keys, values, k=1)(np.minimum(np.arange(frames), keys[-1]))


def eased(values: np.ndarray, keys: np.ndarray, frames: int) -> np.ndarray:
    """As `between`, smoothly and without overshooting (a monotone cubic)."""
    if len(keys) == 1:
        return np.repeat(values, frames, axis=0)
    return PchipInterpolator(keys, values)(np.minimum(np.arange(frames), keys[-1]))
