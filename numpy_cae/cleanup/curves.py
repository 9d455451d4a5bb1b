"""Curves: what a channel of a motion does over time, as differences in metres.

A curve is a joint's rotations (F, 4) or translations (F, 3), in the frames of the file. `between`
is the difference of two of its values: R_i⁻¹ R_j as a rotation vector, or t_j - t_i. Differences of
rotations are multiplied by `lever`, so that all of them are in metres at the end of the body that
the joint moves. The metres are those of a body of usual size (`body_size`): so a threshold holds
for characters of any size, and while the unit of the file is in doubt.

A segment is a run of frames of a curve that may be damaged: it lies between two jumps
(`displaced`), or leaves the cubic through the frames around it (`spikes`).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.cleanup.finding import joint_names
from numpy_cae.mocap.retargeting.body import body_positions
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, RATE, Motion, Skeleton
from numpy_cae.motion.contacts import FEET, foot_speeds, lower_foot, sliding_of
from numpy_cae.motion.quaternions import inverse, product, to_vector

STILL_METRES = 1e-6
"""STILL_METRES: a curve stands still where it changes by no more than this (m; of quaternions, in
their values)."""
LEG_METRES = 0.84
"""LEG_METRES: thigh and shank of a body of usual size are so long together (m), as those of the
mean skeleton of the starter model."""
LEAST_LEVER_METRES = 0.05
"""LEAST_LEVER_METRES: a joint that moves nothing but itself, such as a hand, has this lever (m)."""
JUMP_METRES = (0.05, 0.08)
"""JUMP_METRES: a step is a jump only if it is longer than this (m): the lower one at high rates,
the upper one at low rates."""
JUMP_METRES_A_SECOND_SQUARED = 72.0
"""JUMP_METRES_A_SECOND_SQUARED: in between, a jump is longer than this acceleration (m/s²)
moves a joint in the time of a frame."""


@dataclass(frozen=True, eq=False)
class Curve:
    """The rotations (F, 4) or translations (F, 3) of a joint of the rig.

    `name` is that of `joint_names`. `lever` is the distance in metres that a rotation by one radian
    moves the furthest joint below, or by which a translation is multiplied. `is_root` says that it
    moves the whole body.
    """

    joint: int
    name: str
    values: np.ndarray
    lever: float
    rate: float
    is_root: bool

    @property
    def spike_kind(self) -> str:
        """What a spike of this curve is: of the rotation, the root's place, a bone's length."""
        return "spike" if self.is_rotation else "root elsewhere" if self.is_root else "length"

    @property
    def is_rotation(self) -> bool:
        """Whether the values are quaternions."""
        return self.values.shape[1] == 4

    def amount(self, metres: float) -> str:
        """A difference of rotations in degrees, of places in centimetres."""
        value = metres / self.lever
        return f"{np.degrees(value):.0f}°" if self.is_rotation else f"{100 * value:.1f} cm"

    def between(self, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """The difference of the values in frames i and j, (N, 3), metres."""
        one, other = self.values[i], self.values[j]
        if not self.is_rotation:
            return self.lever * (other - one)
        return self.lever * to_vector(product(inverse(one), other))

    def steps(self, frames: slice = slice(None)) -> np.ndarray:
        """The lengths of the steps to the next frame among F frames, (F - 1,) in metres.

        The chord of a rotation, not its arc: for an hour of motion an arc tangent takes longer than
        everything else.
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


def off_cubic(x: np.ndarray) -> np.ndarray:
    """The difference of each frame of (F, …) from the cubic through the two frames before it and
    the two after it; 0 in the first two and the last two."""
    off = np.zeros(x.shape)
    off[2:-2] = x[2:-2] - (2 / 3) * (x[1:-3] + x[3:-1]) + (x[:-4] + x[4:]) / 6
    return off


def curves_of(motion: Motion) -> Iterator[Curve]:
    """The curves of a motion that change: rotations of joints that move others, or are among the
    twenty, then translations of all."""
    skeleton = motion.skeleton
    size = body_size(motion)
    levers = levers_of(skeleton.scaled(1 / size))
    rig = rig_of(motion)
    names = joint_names(motion)
    root = skeleton.path(rig.joints[0])
    for values in (motion.rotations, motion.translations):
        # One pass over all joints: a pass for each would read an hour from memory sixty times.
        high, low = values.max(axis=0, initial=-np.inf), values.min(axis=0, initial=np.inf)
        change = np.maximum(high - values[:1], values[:1] - low).max(axis=(0, 2), initial=0.0)
        for joint, name in enumerate(names):
            # The last bone of a finger moves no joint.
            counts = values.shape[2] == 3 or joint in skeleton.parents or name in JOINTS
            if counts and change[joint] > STILL_METRES and joint not in rig.added:
                lever = levers[joint] if values.shape[2] == 4 else 1.0 / size
                yield Curve(joint, name, values[:, joint], lever, motion.rate, joint in root)


def body_size(motion: Motion) -> float:
    """The length of the legs of a motion, divided by that of a body of usual size."""
    body = body_positions(motion.at(slice(0, 1)))[0]
    legs = [body[toe - 3 : toe] for toe in FEET]  # hip, knee, ankle
    length = np.linalg.norm(np.diff(legs, axis=1), axis=-1).sum(axis=-1).mean()
    return float(length / LEG_METRES) or 1.0


def usual_body(motion: Motion) -> np.ndarray:
    """The twenty joints of a motion, as those of a body of usual size, (frames, 20, 3) in metres.

    What is judged by these metres is judged alike for characters of any size."""
    return body_positions(motion) / body_size(motion)


def usual_toes(motion: Motion) -> np.ndarray:
    """Both toes of a motion, as those of a body of usual size, (frames, 2, 3) in metres."""
    joints = rig_of(motion).joints
    return motion.positions([joints[toe] for toe in FEET]) / body_size(motion)


def at_about_thirty(motion: Motion) -> tuple[Motion, int]:
    """Every n-th frame of a motion, about thirty a second, and n."""
    step = max(1, round(motion.rate / RATE))
    return replace(motion.at(slice(None, None, step)), rate=motion.rate / step), step


def sliding(motion: Motion) -> float:
    """How fast standing feet slide (`foot_sliding`), cm/s of a body of usual size."""
    return sliding_of(usual_toes(motion), motion.rate)


def slides_of(before: Motion, after: Motion) -> np.ndarray:
    """How fast feet that stand in a motion slide before and after a step of a repair, 0 where none
    stands, (2, frames - 1) in centimetres a second."""
    toes = [usual_toes(motion) for motion in (before, after)]
    lower, on_floor = lower_foot(toes[0])
    stands = on_floor[:, None] & (lower[:, None] == [0, 1])
    return np.where(stands, [foot_speeds(each, before.rate) for each in toes], 0.0).sum(axis=2)


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


def local_median(values: np.ndarray, rate: float) -> np.ndarray:
    """The median of values (N,) over the second around each, for some frames at once."""
    half = max(round(rate / 2), 1)
    some = max(half // 4, 1)
    padded = np.pad(values, (half, half + some), mode="edge")
    medians = np.median(sliding_window_view(padded, 2 * half + 1)[some // 2 :: some], axis=1)
    return np.repeat(medians, some)[: len(values)]


class Segment(NamedTuple):
    """A run of frames of a curve.

    Parameters
    ----------
    first, end : int
        The first frame, and the frame after the last one.
    score : float
        The evidence divided by its threshold: above 1 it is strong enough.
    size : float
        How far the curve is displaced there, in metres; 0 where it was not measured.
    """

    first: int
    end: int
    score: float
    size: float = 0.0

    def __len__(self) -> int:
        return self.end - self.first


def least_jump(rate: float) -> float:
    """The length of the shortest jump at a rate, metres."""
    return float(np.clip(JUMP_METRES_A_SECOND_SQUARED / rate**2, *JUMP_METRES))
