"""Channels: the rotations or the translations of one joint over time, as differences in metres.

A channel is a joint's rotations (F, 4) or translations (F, 3), in the frames of the file. `between`
is the difference of two of its values: R_i⁻¹ R_j as a rotation vector, or t_j - t_i. Differences of
rotations are multiplied by `lever`, so that all of them are in metres at the end of the body that
the joint moves. The metres are those of a body of usual size (`View.size`): so a threshold holds
for characters of any size, and while the unit of the file is in doubt.

A candidate is a run of frames of a channel that may be damaged: it lies between two jumps
(`displacements`), or leaves the cubic through the frames around it (`spikes`).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.cleanup.finding import joint_names
from numpy_cae.cleanup.kinds import BONE, ROOT, ROTATION
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, Motion, Skeleton
from numpy_cae.motion.quaternions import inverse, product, to_vector

STILL_METRES = 1e-6
"""A channel stands still where it changes by no more than this (m; of quaternions, in their
values)."""
LEAST_LEVER_METRES = 0.05
"""The lever of a joint that moves nothing but itself, such as a hand (m)."""
JUMP_METRES = (0.05, 0.08)
"""A step is a jump only if it is longer than this (m): the lower one at high rates, the upper one
at low rates."""
JUMP_METRES_A_SECOND_SQUARED = 72.0
"""At rates in between, a jump is longer than this acceleration (m/s²) moves a joint in the time of
a frame."""


@dataclass(frozen=True, eq=False)
class Channel:
    """The rotations (F, 4) or translations (F, 3) of a joint of the rig.

    Parameters
    ----------
    joint : int
        The index in the rig.
    name : str
        The joint's name in findings (`joint_names`).
    values : (F, 4) or (F, 3) array of float64
    lever : float
        The distance in metres that a rotation by one radian moves the furthest joint below, or the
        factor of a translation.
    rate : float
        Frames a second.
    is_root : bool
        Whether the joint moves the whole body.
    """

    joint: int
    name: str
    values: np.ndarray
    lever: float
    rate: float
    is_root: bool

    @property
    def is_rotation(self) -> bool:
        """Whether the values are quaternions."""
        return self.values.shape[1] == 4

    @property
    def channel(self) -> str:
        """Which channel it is: `ROTATION`, `ROOT` or `BONE`, as in the rows of `KINDS`."""
        if self.is_rotation:
            return ROTATION
        return ROOT if self.is_root else BONE

    def amount(self, metres: float) -> str:
        """A difference of rotations in degrees, of places in centimetres."""
        value = metres / self.lever
        return f"{np.degrees(value):.0f}°" if self.is_rotation else f"{100 * value:.1f} cm"

    def between(self, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """The difference of the values in frames i and j, (N, 3), metres."""
        before = self.values[i]
        after = self.values[j]
        if not self.is_rotation:
            return self.lever * (after - before)
        return self.lever * to_vector(product(inverse(before), after))

    def steps(self, frames: slice = slice(None)) -> np.ndarray:
        """The lengths of the steps to the next frame among F frames, (F - 1,) in metres.

        The chord of a rotation, not its arc: the arc tangent would take longer than everything
        else.
        """
        values = self.values[frames]
        if not self.is_rotation:
            return self.lever * np.linalg.norm(np.diff(values, axis=0), axis=-1)
        dot = np.abs(np.einsum("ij,ij->i", values[1:], values[:-1]))
        return 2 * self.lever * np.sqrt(np.maximum(1 - dot * dot, 0.0))

    def continuous(self) -> np.ndarray:
        """The values in metres, quaternions without changes of sign: their distances are those of
        `between`, of small rotations."""
        if not self.is_rotation:
            return self.lever * self.values
        dot = np.einsum("ij,ij->i", self.values[1:], self.values[:-1])
        signs = np.cumprod(np.where(dot < 0, -1.0, 1.0))
        return 2 * self.lever * self.values * np.r_[1.0, signs][:, None]

    def roughness(self) -> np.ndarray:
        """How far each frame is from its cubic (`off_cubic`), (F,) in metres."""
        off = off_cubic(self.continuous())
        return np.sqrt(np.einsum("ij,ij->i", off, off))


class Candidate(NamedTuple):
    """A run of frames of a channel that may be damaged.

    Parameters
    ----------
    first, end : int
        The first frame, and the frame after the last one.
    score : float
        The evidence divided by its threshold: above 1 it is strong enough.
    size : float
        How far the channel is displaced there, in metres; 0 where it was not measured.
    """

    first: int
    end: int
    score: float
    size: float = 0.0

    def __len__(self) -> int:
        return self.end - self.first


def channels_of(motion: Motion, size: float) -> Iterator[Channel]:
    """The channels of a motion that change: rotations of joints that move others, or are among the
    twenty, then translations of all. `size` is that of its body (`View.size`)."""
    skeleton = motion.skeleton
    levers = levers_of(skeleton.scaled(1 / size))
    rig = rig_of(motion)
    names = joint_names(motion)
    root = skeleton.path(rig.joints[0])
    for values in (motion.rotations, motion.translations):
        is_rotation = values.shape[2] == 4
        high = values.max(axis=0, initial=-np.inf)
        low = values.min(axis=0, initial=np.inf)
        change = np.maximum(high - values[:1], values[:1] - low).max(axis=(0, 2), initial=0.0)
        for joint, name in enumerate(names):
            if change[joint] <= STILL_METRES or joint in rig.added:
                continue
            # The last bone of a finger moves no joint.
            if is_rotation and joint not in skeleton.parents and name not in JOINTS:
                continue
            lever = levers[joint] if is_rotation else 1.0 / size
            yield Channel(joint, name, values[:, joint], lever, motion.rate, joint in root)


def levers_of(skeleton: Skeleton) -> np.ndarray:
    """The distance from each joint of a rig to the furthest joint or end below it, (J,) metres."""
    levers = np.full(len(skeleton.names), LEAST_LEVER_METRES)
    for joint in reversed(range(len(levers))):
        if joint in skeleton.end_sites:
            levers[joint] = max(levers[joint], np.linalg.norm(skeleton.end_sites[joint]))
        parent = skeleton.parents[joint]
        length = np.linalg.norm(skeleton.offsets[joint])
        if parent >= 0:
            below = levers[joint] if skeleton.children(joint) else 0.0
            levers[parent] = max(levers[parent], length + below)
    return levers


def off_cubic(x: np.ndarray) -> np.ndarray:
    """The difference of each frame of (F, …) from the cubic through the two frames before it and
    the two after it; 0 in the first two and the last two."""
    off = np.zeros(x.shape)
    off[2:-2] = x[2:-2] - (2 / 3) * (x[1:-3] + x[3:-1]) + (x[:-4] + x[4:]) / 6
    return off


def local_median(values: np.ndarray, rate: float) -> np.ndarray:
    """The median of values (N,) over the second around each, for some frames at once."""
    half = max(round(rate / 2), 1)
    some = max(half // 4, 1)
    padded = np.pad(values, (half, half + some), mode="edge")
    medians = np.median(sliding_window_view(padded, 2 * half + 1)[some // 2 :: some], axis=1)
    return np.repeat(medians, some)[: len(values)]


def least_jump(rate: float) -> float:
    """The length of the shortest jump at a rate, metres."""
    return float(np.clip(JUMP_METRES_A_SECOND_SQUARED / rate**2, *JUMP_METRES))
