"""Eight kinds of damage to a motion in the rig of its file, for `python -m studies damage`.

Each function returns the damaged motion and the mask of its damaged joints and frames. The last
kind is one of Mu et al., "StableMotion: Training Motion Cleanup Models with Unpaired Corrupted
Data" (SIGGRAPH Asia 2025, arXiv:2505.03154), with the numbers of the authors' program
(github.com/Murrol/StableMotion, `motion_artifacts_smpl`), where motions have 20 frames a second.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.mocap import body_positions, find_joints, retarget
from numpy_cae.motion import JOINTS, RATE, Motion
from numpy_cae.motion.fit import bend_limb
from numpy_cae.motion.joints import LIMBS, joint_mask
from numpy_cae.motion.quaternions import slerp

Rng = np.random.Generator
Damaged = tuple[Motion, np.ndarray]
"""The damaged motion and the mask of what is damaged, (frames, 20) bool."""

SECONDS = (0.3, 3.0)
"""The range of the length of a stretch of damage if the take is long enough (s)."""
EASED = ("frozen in channels", "frozen in the world", "twisted leg", "missing marker")
"""Damage of these kinds may begin and end over some frames (`eased`)."""
ONSETS = (0, 1, 2, 4, 8)
"""In so many frames at 30 a second."""
TWIST = 50.0
"""The angle of a twisted leg (degrees)."""
SPIKE = (20.0, 60.0)
"""The range of angles of spikes (degrees)."""
JITTER = np.radians(1.5)
"""The standard deviation of the rotation about each axis (rad)."""
ROOT_JITTER = 0.004
"""The standard deviation of the root's position (m)."""
LONG = (1.0, 2.0)
"""The range of the length of damage as in StableMotion (s)."""
NOISE = 0.1
"""The standard deviation of noise of quaternions, times 0.5 to 1; a number of StableMotion."""
MOST_NOISE = 0.5
"""The bound of this noise; a number of StableMotion."""
WRONG = 0.001
"""A joint that damage moves by more than this (m) is damaged."""


def stretch(motion: Motion, seconds: float, rng: Rng) -> slice:
    """Random successive frames of a motion, with an eighth of the motion or more on both sides."""
    margin = len(motion) // 8
    count = max(1, min(round(seconds * motion.rate), len(motion) - 2 * margin - 1))
    first = int(rng.integers(margin, len(motion) - margin - count))
    return slice(first, first + count)


def eased(motion: Motion, damaged: Motion, mask: np.ndarray, onset: int) -> Motion:
    """Damage that begins and ends over `onset` frames at 30 a second within its stretch."""
    frame = np.arange(len(motion))
    first, *_, last = np.flatnonzero(mask.any(axis=1))
    steps = onset * motion.rate / RATE + 1
    share = np.clip(np.minimum(frame - first + 1, last + 1 - frame) / steps, 0.0, 1.0)[:, None]
    rotations = slerp(motion.rotations, damaged.rotations, share)
    translations = motion.translations + share[..., None] * (
        damaged.translations - motion.translations
    )
    return replace(motion, rotations=rotations, translations=translations)


def spikes(motion: Motion, rng: Rng) -> Damaged:
    """One or two frames in which a limb turns by 20 to 60 degrees, about once a second."""
    mask = np.zeros((len(motion), len(JOINTS)), bool)
    for first in rng.integers(1, len(motion) - 2, max(1, round(motion.seconds))):
        frames = slice(int(first), int(first + rng.integers(1, 3)))
        motion, spike = _turn(motion, frames, rng.uniform(*SPIKE), rng)
        mask |= spike
    return motion, mask


def twisted_limb(motion: Motion, rng: Rng) -> Damaged:
    """A leg turns by 50 degrees at the hip for a stretch."""
    leg = f"{rng.choice(['left', 'right'])}_leg"
    return _turn(motion, stretch(motion, rng.uniform(*SECONDS), rng), TWIST, rng, leg)


def _turn(
    motion: Motion, frames: slice, degrees: float, rng: Rng, limb: str | None = None
) -> Damaged:
    """Turn a limb at its hip or shoulder, in its own frame or its parent's, about a random axis."""
    names = LIMBS[limb or str(rng.choice(list(LIMBS)))]
    rig = find_joints(motion.skeleton)
    rotations = motion.rotations.copy()
    first = JOINTS.index(names[0])
    joint = rig[first - 1]  # a limb's joints follow one another
    child = rig[first]
    axis = np.cross(motion.skeleton.offsets[child], rng.normal(size=3))
    turn = Rotation.from_rotvec(np.radians(degrees) * axis / np.linalg.norm(axis))
    before = Rotation.from_quat(rotations[frames, joint])
    in_parent = rng.random() < 0.5
    rotations[frames, joint] = (turn * before if in_parent else before * turn).as_quat()
    return replace(motion, rotations=rotations), joint_mask(len(motion), names, frames)


def frozen_in_channels(motion: Motion, rng: Rng) -> Damaged:
    """The rotations of a shoulder and an elbow stay constant for a stretch."""
    side = rng.choice(["left", "right"])
    frames = stretch(motion, rng.uniform(*SECONDS), rng)
    rig = find_joints(motion.skeleton)
    rotations = motion.rotations.copy()
    for name in ("shoulder", "elbow"):
        joint = rig[JOINTS.index(f"{side}_{name}")]
        rotations[frames, joint] = rotations[frames.start, joint]
    mask = joint_mask(len(motion), LIMBS[f"{side}_arm"], frames)
    return replace(motion, rotations=rotations), mask


def frozen_in_world(motion: Motion, rng: Rng) -> Damaged:
    """A wrist stays at one point of the world for a stretch, as far as the arm reaches."""
    side = rng.choice(["left", "right"])
    frames = stretch(motion, rng.uniform(*SECONDS), rng)
    positions = body_positions(motion)
    arm = [JOINTS.index(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist")]
    chain = positions[frames][:, arm]
    upper, lower = np.linalg.norm(np.diff(chain, axis=1), axis=-1).T
    way = chain[0, 2] - chain[:, 0]
    distance = np.linalg.norm(way, axis=-1)
    reached = distance.clip(np.abs(upper - lower) + WRONG, upper + lower - WRONG)
    wrist = chain[:, 0] + way * (reached / np.maximum(distance, 1e-9))[:, None]
    positions[frames, arm[1]] = bend_limb(chain[:, 0], chain, chain[:, 1], wrist)
    positions[frames, arm[2]] = wrist
    mask = joint_mask(len(motion), LIMBS[f"{side}_arm"], frames)
    return retarget(motion, positions, mask), mask


def missing_marker(motion: Motion, rng: Rng) -> Damaged:
    """A forearm is in the rest pose for a stretch, as if the marker of the wrist were missing."""
    side = rng.choice(["left", "right"])
    frames = stretch(motion, rng.uniform(*SECONDS), rng)
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
    rotations = motion.rotations.copy()
    translations = motion.translations.copy()
    for joint in find_joints(motion.skeleton):
        noise = Rotation.from_rotvec(JITTER * rng.normal(size=(len(motion), 3)))
        rotations[:, joint] = (Rotation.from_quat(rotations[:, joint]) * noise).as_quat()
    translations[:, 0] += ROOT_JITTER * rng.normal(size=(len(motion), 3))
    everything = np.ones((len(motion), len(JOINTS)), bool)
    return replace(motion, rotations=rotations, translations=translations), everything


def jitter_of_some(motion: Motion, rng: Rng) -> Damaged:
    """Noise on the quaternions of random joints, of both legs or of one leg, for 1 to 2 s."""
    frames = stretch(motion, rng.uniform(*LONG), rng)
    rig = find_joints(motion.skeleton)
    left_leg = [JOINTS.index(name) for name in LIMBS["left_leg"]]
    right_leg = [JOINTS.index(name) for name in LIMBS["right_leg"]]
    some = rng.permutation(len(JOINTS))[: rng.integers(1, len(JOINTS) + 1)].tolist()
    groups = [some, left_leg + right_leg, left_leg, right_leg]
    chosen = groups[rng.choice(4, p=[0.4, 0.3, 0.15, 0.15])]
    rotations = motion.rotations.copy()
    for joint in chosen:
        q = rotations[frames, rig[joint]]
        noise = NOISE * rng.uniform(0.5, 1.0) * rng.normal(size=q.shape)
        q += noise.clip(-MOST_NOISE, MOST_NOISE)
        rotations[frames, rig[joint]] = q / np.linalg.norm(q, axis=-1, keepdims=True)
    damaged = replace(motion, rotations=rotations)
    off = np.linalg.norm(body_positions(damaged) - body_positions(motion), axis=-1)
    farthest = off[frames].max(axis=0)
    wrong = [name for name, metres in zip(JOINTS, farthest, strict=True) if metres > WRONG]
    return damaged, joint_mask(len(motion), wrong, frames)


DAMAGES: dict[str, Callable[[Motion, Rng], Damaged]] = {
    "frozen in channels": frozen_in_channels,
    "frozen in the world": frozen_in_world,
    "spikes": spikes,
    "twisted leg": twisted_limb,
    "missing marker": missing_marker,
    "dropped frames": dropped_frames,
    "jitter": jitter,
    "jitter of some joints": jitter_of_some,
}
"""Kind of damage to the function that makes it."""
