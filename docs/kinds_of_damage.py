"""Seven kinds of damage to a motion in the rig of its file, for docs/damage.py.

Each function returns the damaged motion and the mask of its damaged joints and frames.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.experiments.repair.damaged_motion import (
    SECONDS,
    Damaged,
    Rng,
    spikes,
    stretch,
    twisted_limb,
)
from numpy_cae.motion import JOINTS, Motion, body_positions, find_joints, retarget
from numpy_cae.motion.joints import LIMBS, joint_mask

JITTER, ROOT_JITTER = np.radians(1.5), 0.004
"""Standard deviations of the rotation about each axis, in radians, and of the root's position, in
metres."""


def frozen_in_channels(motion: Motion, rng: Rng) -> Damaged:
    """The rotations of a shoulder and an elbow stay constant for a stretch."""
    side, frames = rng.choice(["left", "right"]), stretch(motion, SECONDS, rng)
    rig, rotations = find_joints(motion.skeleton), motion.rotations.copy()
    for name in ("shoulder", "elbow"):
        joint = rig[JOINTS.index(f"{side}_{name}")]
        rotations[frames, joint] = rotations[frames.start, joint]
    mask = joint_mask(len(motion), LIMBS[f"{side}_arm"], frames)
    return replace(motion, rotations=rotations), mask


def frozen_in_world(motion: Motion, rng: Rng) -> Damaged:
    """A wrist stays at one point of the world for a stretch, as far as the arm reaches."""
    side, frames = rng.choice(["left", "right"]), stretch(motion, SECONDS, rng)
    positions = body_positions(motion)
    shoulder, elbow, wrist = (
        JOINTS.index(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist")
    )
    chain = positions[frames, shoulder], positions[frames, elbow], positions[frames, wrist]
    bent = _bend(*chain, positions[frames.start, wrist])
    positions[frames, elbow], positions[frames, wrist] = bent
    mask = joint_mask(len(motion), LIMBS[f"{side}_arm"], frames)
    return retarget(motion, positions, mask), mask


def missing_marker(motion: Motion, rng: Rng) -> Damaged:
    """A forearm is in the rest pose for a stretch, as if the marker of the wrist were missing."""
    side, frames = rng.choice(["left", "right"]), stretch(motion, SECONDS, rng)
    rotations = motion.rotations.copy()
    elbow = find_joints(motion.skeleton)[JOINTS.index(f"{side}_elbow")]
    rotations[frames, elbow] = (0.0, 0.0, 0.0, 1.0)
    mask = joint_mask(len(motion), [f"{side}_wrist"], frames)
    return replace(motion, rotations=rotations), mask


def dropped_frames(motion: Motion, rng: Rng) -> Damaged:
    """Two stretches of a quarter to half of a second repeat the pose before them."""
    mask = np.zeros((len(motion), len(JOINTS)), bool)
    for _ in range(2):
        frames = stretch(motion, rng.uniform(0.25, 0.5), rng)
        shown = np.arange(len(motion))
        shown[frames] = frames.start - 1
        motion = motion.at(shown)
        mask[frames] = True
    return motion, mask


def jitter(motion: Motion, rng: Rng) -> Damaged:
    """Noise on the position of the root and on the rotations of all twenty joints."""
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    for joint in find_joints(motion.skeleton):
        noise = Rotation.from_rotvec(JITTER * rng.normal(size=(len(motion), 3)))
        rotations[:, joint] = (Rotation.from_quat(rotations[:, joint]) * noise).as_quat()
    translations[:, 0] += ROOT_JITTER * rng.normal(size=(len(motion), 3))
    everything = np.ones((len(motion), len(JOINTS)), bool)
    return replace(motion, rotations=rotations, translations=translations), everything


def _bend(
    shoulder: np.ndarray, elbow: np.ndarray, wrist: np.ndarray, target: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Positions of elbow and wrist, each (F, 3), of arms that reach for a point.

    The arm bends in the plane in which it bent before.
    """
    upper = np.linalg.norm(elbow - shoulder, axis=-1, keepdims=True)
    lower = np.linalg.norm(wrist - elbow, axis=-1, keepdims=True)
    direction = target - shoulder
    distance = np.linalg.norm(direction, axis=-1, keepdims=True)
    direction = direction / np.maximum(distance, 1e-9)
    distance = np.clip(distance, np.abs(upper - lower) + 1e-3, upper + lower - 1e-3)
    along = (upper**2 - lower**2 + distance**2) / (2 * distance)
    across = elbow - shoulder
    across = across - np.sum(across * direction, axis=-1, keepdims=True) * direction
    across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
    height = np.sqrt(np.maximum(upper**2 - along**2, 0.0))
    return shoulder + along * direction + height * across, shoulder + distance * direction


DAMAGES: dict[str, Callable[[Motion, Rng], Damaged]] = {
    "frozen in channels": frozen_in_channels,
    "frozen in the world": frozen_in_world,
    "spikes": spikes,
    "twisted leg": twisted_limb,
    "missing marker": missing_marker,
    "dropped frames": dropped_frames,
    "jitter": jitter,
}
