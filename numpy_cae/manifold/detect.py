"""Detection of damaged joints: by their distance from the manifold, and by direct tests."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import binary_dilation, binary_opening, binary_propagation, median_filter

from numpy_cae.manifold.fill import fill, whole_features
from numpy_cae.manifold.holes import at_thirty
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.body import Body
from numpy_cae.motion.features import POSITIONS
from numpy_cae.motion.joints import JOINTS, PARENTS

RATIO, LEAST = 4.0, 0.05
"""A joint is damaged where it is further from the manifold than `RATIO` times its median in the
clip and than `LEAST` metres; its damage reaches as far as half of that is exceeded."""
FROZEN_SHARE = 0.4
"""A joint that does not move is damaged from this share of these distances on."""
ROUNDS = 3
"""Times that what was found is filled in and the rest is tested again."""
MARGIN = 2
"""Frames on both sides of damage that are taken for damaged."""
SPIKE = 0.05
"""Metres by which a spike is off the median of its neighbours."""
STRETCHED = 0.15
"""Share of its length by which a bone of wrong length differs from the usual one."""
STILL, STILL_FRAMES = 3e-4, 6
"""Metres a frame below which a joint does not move, and for how many frames that is suspicious."""

_ALONG_TIME = np.ones((3, 1), bool)
_GRANDPARENTS = [PARENTS[max(parent, 0)] for parent in PARENTS]


def find_damage(manifold: MotionManifold, body: Body) -> np.ndarray:
    """The damaged joints of a motion: (F, 20) bool, at 30 frames a second.

    A joint is damaged where `direct_damage` says so or where it is far from its projection. What is
    found is filled in, since damage also moves the projection of other joints, and the rest is
    tested again.
    """
    found = at_thirty(body.motion, direct_damage(body))
    still = find_still(body.positions, body.features)
    for _ in range(ROUNDS):
        features, _ = whole_features(body, found)
        distance = residual(manifold, features, found)
        level = distance / np.maximum(LEAST, RATIO * typical(distance, found))
        far = binary_propagation(level > 1, _ALONG_TIME, mask=level > 0.5)
        far |= binary_propagation(still & (level > FROZEN_SHARE), _ALONG_TIME, mask=still)
        far &= ~found
        if not far.any():
            break
        found |= binary_dilation(far, np.ones((2 * MARGIN + 1, 1), bool))
    return found


def residual(manifold: MotionManifold, features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The distance of each joint from the projection of the motion with its missing joints filled
    in: (F, 20) in metres.

    The median difference of each joint over the clip does not count: rigs place the joints of a
    body differently.
    """
    projected = manifold.project(fill(manifold, features, missing), manifold.shifts)
    difference = (features - projected)[:, POSITIONS].reshape(-1, len(JOINTS), 3)
    return np.linalg.norm(difference - typical(difference, missing), axis=-1)


def typical(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The median of each joint's values (F, 20, …) over the frames in which it is not missing."""
    gone = missing & ~missing.all(axis=0)
    gone = gone.reshape(*gone.shape, *[1] * (values.ndim - 2))
    return np.nanmedian(np.where(gone, np.nan, values), axis=0)


def direct_damage(body: Body) -> np.ndarray:
    """Damage that shows without a manifold: (frames, 20) bool in the frames of the file."""
    positions = body.positions_in_file
    return find_spikes(positions) | find_stretched(positions)


def find_spikes(positions: np.ndarray) -> np.ndarray:
    """Joints that are elsewhere for one to three frames: positions (F, 20, 3) to (F, 20) bool.

    A spike is further from the median of seven frames than `SPIKE` and than four times the distance
    that is usual where the joint moves fast. Joints below it in the body, which it moves as well,
    are found too.
    """
    from_hips = positions - positions[:, :1]
    off = np.linalg.norm(from_hips - median_filter(from_hips, (7, 1, 1), mode="nearest"), axis=-1)
    return (off > SPIKE) & (off > 4 * np.percentile(off, 90, axis=0))


def find_stretched(positions: np.ndarray) -> np.ndarray:
    """Joints whose bone is not as long as usual: positions (F, 20, 3) to (F, 20) bool."""
    lengths = np.linalg.norm(positions - positions[:, PARENTS], axis=-1)
    usual = np.median(lengths, axis=0)
    wrong = np.abs(lengths - usual) > np.maximum(0.02, STRETCHED * usual)
    wrong[:, 0] = False
    return wrong


def find_still(positions: np.ndarray, features: np.ndarray) -> np.ndarray:
    """Joints that stop moving although they move in most of the clip: (F, 20) bool.

    A joint is still in the world, in the body's frame, or at a constant distance from the parent of
    its parent, as where the file repeats a rotation. Feet that stand and hands that rest are among
    them: this alone is no damage.
    """
    local = features[:, POSITIONS].reshape(positions.shape)
    reach = np.linalg.norm(positions - positions[:, _GRANDPARENTS], axis=-1, keepdims=True)
    still = np.zeros(positions.shape[:2], bool)
    for place in (positions, local, reach):
        speed = np.linalg.norm(np.diff(place, axis=0, append=place[-1:]), axis=-1)
        rests = binary_opening(speed < STILL, np.ones((STILL_FRAMES, 1), bool))
        still |= rests & (rests.mean(axis=0) < 0.5)
    return still
