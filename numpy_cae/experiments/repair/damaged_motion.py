"""Damage to a motion in the rig of its file; docs/kinds_of_damage.py has more kinds.

Each function returns the damaged motion and the mask of its damaged joints and frames.
"""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion import JOINTS, Motion, find_joints
from numpy_cae.motion.joints import LIMBS, joint_mask

Rng = np.random.Generator
Damaged = tuple[Motion, np.ndarray]
"""The damaged motion and the mask of what is damaged, (frames, 20) bool."""

SECONDS = 1.5
"""The length of a stretch of damage if the take is long enough."""
TWIST, SPIKE = 50.0, (20.0, 60.0)
"""The angle of a twisted leg and the range of angles of spikes, in degrees."""


def stretch(motion: Motion, seconds: float, rng: Rng) -> slice:
    """Random successive frames of a motion, with an eighth of the motion or more on both sides."""
    margin = len(motion) // 8
    count = max(1, min(round(seconds * motion.rate), len(motion) - 2 * margin - 1))
    first = int(rng.integers(margin, len(motion) - margin - count))
    return slice(first, first + count)


def spikes(motion: Motion, rng: Rng) -> Damaged:
    """One or two frames in which a limb turns by 20 to 60 degrees, about once a second."""
    mask = np.zeros((len(motion), len(JOINTS)), bool)
    for first in rng.integers(1, len(motion) - 2, max(1, round(motion.seconds))):
        frames = slice(int(first), int(first + rng.integers(1, 3)))
        motion, spike = _turned(motion, frames, rng.uniform(*SPIKE), rng)
        mask |= spike
    return motion, mask


def twisted_limb(motion: Motion, rng: Rng) -> Damaged:
    """A leg turns by 50 degrees at the hip for a stretch."""
    leg = f"{rng.choice(['left', 'right'])}_leg"
    return _turned(motion, stretch(motion, SECONDS, rng), TWIST, rng, leg)


def _turned(
    motion: Motion, frames: slice, degrees: float, rng: Rng, limb: str | None = None
) -> Damaged:
    """Turn a limb at its hip or shoulder about a random axis perpendicular to the bone."""
    names = LIMBS[limb or str(rng.choice(list(LIMBS)))]
    rig, rotations = find_joints(motion.skeleton), motion.rotations.copy()
    first = JOINTS.index(names[0])
    joint, child = rig[first - 1], rig[first]  # a limb's joints follow one another
    axis = np.cross(motion.skeleton.offsets[child], rng.normal(size=3))
    turn = Rotation.from_rotvec(np.radians(degrees) * axis / np.linalg.norm(axis))
    rotations[frames, joint] = (Rotation.from_quat(rotations[frames, joint]) * turn).as_quat()
    return replace(motion, rotations=rotations), joint_mask(len(motion), names, frames)
