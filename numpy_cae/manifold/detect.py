"""Detection of damaged joints: by their distance from the manifold, and by direct tests."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import binary_dilation, median_filter

from numpy_cae.manifold.fill import fill, whole_features
from numpy_cae.manifold.holes import at_thirty
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.body import Body
from numpy_cae.motion.features import POSITIONS
from numpy_cae.motion.joints import JOINTS, PARENTS

RATIO, LEAST = 4.0, 0.05
"""A joint is damaged where it is further from the manifold than `RATIO` times its median in the
clip and than `LEAST` metres."""
ROUNDS = 3
"""Times that what was found is filled in and the rest is tested again."""
MARGIN = 2
"""Frames on both sides of damage that are taken for damaged."""


def find_damage(manifold: MotionManifold, body: Body) -> np.ndarray:
    """The damaged joints of a motion: (F, 20) bool, at 30 frames a second.

    A joint is damaged where `direct_damage` says so or where it is far from its projection. What is
    found is filled in, since damage also moves the projection of other joints, and the rest is
    tested again.
    """
    found = at_thirty(body.motion, direct_damage(body))
    features, _ = whole_features(body, found)
    for _ in range(ROUNDS):
        distance = residual(manifold, features, found)
        far = (distance > LEAST) & (distance > RATIO * typical(distance, found)) & ~found
        if not far.any():
            break
        found |= binary_dilation(far, np.ones((2 * MARGIN + 1, 1), bool))
        features, _ = whole_features(body, found)
    return found


def residual(manifold: MotionManifold, features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The distance of each joint from the projection of the motion with its missing joints filled
    in: (F, 20) in metres."""
    filled = fill(manifold, features, missing)
    difference = features - manifold.project(filled, manifold.shifts)
    return np.linalg.norm(difference[:, POSITIONS].reshape(-1, len(JOINTS), 3), axis=-1)


def typical(distance: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The median of each joint's distance over the frames where it is not missing: (20,)."""
    known = np.where(missing & ~missing.all(axis=0), np.nan, distance)
    return np.nanmedian(known, axis=0)


def direct_damage(body: Body) -> np.ndarray:
    """What needs no manifold: (frames, 20) bool in the frames of the file."""
    positions = body.positions_in_file
    return find_spikes(positions) | find_stretched(positions)


SPIKE = 0.05
"""Metres by which a spike leaves the median of its neighbours."""


def find_spikes(positions: np.ndarray) -> np.ndarray:
    """Joints that leave their way for one or two frames: positions (F, 20, 3) to (F, 20) bool.

    A spike is further from the median of seven frames than `SPIKE` and than four times the largest
    distance that is usual in the clip.
    """
    from_hips = positions - positions[:, :1]
    off = np.linalg.norm(from_hips - median_filter(from_hips, (7, 1, 1), mode="nearest"), axis=-1)
    return (off > SPIKE) & (off > 4 * np.percentile(off, 90, axis=0))


def find_stretched(positions: np.ndarray) -> np.ndarray:
    """Joints whose bone is not as long as usual: positions (F, 20, 3) to (F, 20) bool."""
    lengths = np.linalg.norm(positions - positions[:, PARENTS], axis=-1)
    usual = np.median(lengths, axis=0)
    wrong = np.abs(lengths - usual) > np.maximum(0.02, 0.15 * usual)
    wrong[:, 0] = False
    return wrong
