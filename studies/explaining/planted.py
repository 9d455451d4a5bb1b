"""Damage planted in clean motion: a second generator, which shares nothing with
`studies.shared.damages`, so that a finder is not judged by the damage that it was made for.

Each function plants one event and returns the damaged motion with a `Planted` that says where it
is. An event begins and ends over `onset` frames of the file: its share rises from 0 to 1 by
3u² - 2u³, so that an onset of 0 is a step from one frame to the next.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.finding import joint_names
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, PARENTS, Motion
from numpy_cae.motion.quaternions import angle, from_vector, inverse, product, rotate, slerp

ONSETS = (0, 1, 2, 4, 8)
"""The frames of the file over which an event may begin, and end."""
SPIKED = [
    joint for joint in JOINTS if joint.endswith(("spine", "chest", "elbow", "hip", "knee", "ankle"))
]
"""The joints that may have a spike."""
TURNED = ("left_hip", "right_shoulder", "right_hip", "left_shoulder")
"""The joints that may be turned."""
HELD = ("left_elbow", "right_knee", "right_shoulder", "left_hip", "right_elbow", "left_knee")
"""The joints that may be held."""
SPIKE_DEGREES = (30.0, 120.0)
TURN_DEGREES = (30.0, 70.0)
OFFSET_METRES = (0.1, 0.4)
TURN_SECONDS = (0.4, 1.2)
OFFSET_SECONDS = (0.2, 1.0)
HOLD_SECONDS = (0.3, 0.9)
"""Sizes and durations of events are drawn evenly between these."""
LEAST_TURN_METRES = 0.1
"""A turn that moves the joints of the limb by less than this (m) in the mean is drawn again."""
LEAST_HELD_DEGREES = 20.0
"""A joint is held only where its rotation moves by at least this (°) meanwhile."""
LEAST_WORLD_METRES = 0.1
"""A wrist is held in the world only where it moves by at least this (m) meanwhile."""
TRIES = 20
"""At most this many places are drawn for an event that needs movement."""
MARGIN_SECONDS = 0.15
"""An event has at least this distance (s) from both ends of the frames in which it may be."""
SWEEPS = 30
"""Rounds of the inverse kinematics (`_reach`)."""


class Planted(NamedTuple):
    """An event that was planted: its kind, the joint (of the twenty, or "body"), its first and last
    frame, and the frames of its onset."""

    kind: str
    joint: str
    first: int
    last: int
    onset: int = 0

    @property
    def stretch(self) -> slice:
        """The frames of the event."""
        return slice(self.first, self.last + 1)


class NoPlaceError(ValueError):
    """The motion has no place for an event."""


Plant = Callable[[Motion, slice, np.random.Generator, int, str], tuple[Motion, Planted]]
"""Plants one event in some frames of a motion with an onset, at a joint: "" draws it."""


def plant_spike(
    motion: Motion, frames: slice, rng: np.random.Generator, onset: int = 0, joint: str = ""
) -> tuple[Motion, Planted]:
    """A rotation that is another in one to three frames; the onset is ignored."""
    joint = joint or str(rng.choice(SPIKED))
    length = int(rng.integers(1, 4))
    first = _draw_first(motion, frames, length, rng)
    vector = np.radians(rng.uniform(*SPIKE_DEGREES)) * _direction(rng)
    share = rng.uniform(0.7, 1.0, size=(length, 1))
    rotations = motion.rotations.copy()
    column = index_of(motion, joint)
    inside = slice(first, first + length)
    rotations[inside, column] = product(rotations[inside, column], from_vector(share * vector))
    event = Planted("spike", joint, first, first + length - 1)
    return replace(motion, rotations=rotations), event


def plant_turn(
    motion: Motion, frames: slice, rng: np.random.Generator, onset: int = 0, joint: str = ""
) -> tuple[Motion, Planted]:
    """A hip or a shoulder turned by a constant turn, in its own frame or in its parent's."""
    joint = joint or str(rng.choice(TURNED))
    first, last = _draw_stretch(motion, frames, TURN_SECONDS, onset, rng)
    event = Planted("turned", joint, first, last, onset)
    for _ in range(TRIES):
        vector = np.radians(rng.uniform(*TURN_DEGREES)) * _direction(rng)
        turned = turn_joint(motion, event, vector, bool(rng.random() < 0.5))
        if mean_distance(turned, motion, event) >= LEAST_TURN_METRES:
            return turned, event
    raise NoPlaceError("no turn moves the limb enough")


def plant_offset(
    motion: Motion, frames: slice, rng: np.random.Generator, onset: int = 0, joint: str = ""
) -> tuple[Motion, Planted]:
    """The root at another place, mostly beside its own; the joint is ignored."""
    first, last = _draw_stretch(motion, frames, OFFSET_SECONDS, onset, rng)
    event = Planted("root offset", joint_names(motion)[0], first, last, onset)
    offset = rng.uniform(*OFFSET_METRES) * _direction(rng, (1.0, 0.3, 1.0))
    translations = motion.translations.copy()
    translations[event.stretch, 0] += share_of(event)[:, None] * offset
    return replace(motion, translations=translations), event


def plant_hold(
    motion: Motion, frames: slice, rng: np.random.Generator, onset: int = 0, joint: str = ""
) -> tuple[Motion, Planted]:
    """The rotation of one joint stands still where it moves, and then goes on."""
    for _ in range(TRIES):
        name = joint or str(rng.choice(HELD))
        first, last = _draw_stretch(motion, frames, HOLD_SECONDS, onset, rng)
        event = Planted("hold", name, first, last, onset)
        column = index_of(motion, name)
        true = motion.rotations[event.stretch, column]
        held = np.broadcast_to(true[onset], true.shape)
        if np.degrees(angle(product(inverse(held), true))).max() >= LEAST_HELD_DEGREES:
            rotations = motion.rotations.copy()
            rotations[event.stretch, column] = slerp(true, held, share_of(event))
            return replace(motion, rotations=rotations), event
    raise NoPlaceError("no joint moves enough")


def plant_world_hold(
    motion: Motion, frames: slice, rng: np.random.Generator, onset: int = 0, joint: str = ""
) -> tuple[Motion, Planted]:
    """The wrist of an arm stays at a place of the world, by inverse kinematics (`_reach`)."""
    for _ in range(TRIES):
        name = joint or str(rng.choice([name for name in TURNED if name.endswith("shoulder")]))
        first, last = _draw_stretch(motion, frames, TURN_SECONDS, onset, rng)
        event = Planted("arm held", name, first, last, onset)
        wrist = index_of(motion, name.replace("shoulder", "wrist"))
        part = motion.at(event.stretch)
        path = part.positions([wrist])[:, 0]
        if np.linalg.norm(path - path[onset], axis=1).max() < LEAST_WORLD_METRES:
            continue
        shoulder = index_of(motion, name)
        elbow = index_of(motion, name.replace("shoulder", "elbow"))
        reached = _reach(part, shoulder, elbow, wrist, path[onset])
        rotations = motion.rotations.copy()
        for column in (shoulder, elbow):
            true = rotations[event.stretch, column]
            rotations[event.stretch, column] = slerp(
                true, reached.rotations[:, column], share_of(event)
            )
        return replace(motion, rotations=rotations), event
    raise NoPlaceError("no wrist moves enough")


def plant_cut(
    motion: Motion, frames: slice, rng: np.random.Generator, onset: int = 0, joint: str = ""
) -> tuple[Motion, Planted]:
    """From a frame on another part of the motion, turned and at another place; onset and joint are
    ignored. The motion has as many frames as before, or fewer."""
    first = _draw_first(motion, frames, 1, rng)
    away = max(1, round(0.5 * motion.rate))
    starts = np.r_[0 : max(first - away, 0), first + away : len(motion) - away]
    if not len(starts):
        raise NoPlaceError("the motion is too short for a cut")
    start = int(rng.choice(starts))
    order = np.r_[0:first, start : min(start + len(motion) - first, len(motion))]
    joined = motion.at(order)
    turn = from_vector(np.array([0.0, rng.uniform(0.5, 5.8), 0.0]))
    place = motion.translations[first - 1, 0] + rng.uniform(0.3, 1.0) * _direction(rng, (1, 0, 1))
    path = joined.translations[first:, 0]
    moved = rotate(turn, path - path[0]) + place * [1, 0, 1] + path[0] * [0, 1, 0]
    joined.translations[first:, 0] = moved
    joined.rotations[first:, 0] = product(turn, joined.rotations[first:, 0])
    return joined, Planted("cut", "body", first, first)


PLANTS: dict[str, Plant] = {
    "spike": plant_spike,
    "turned": plant_turn,
    "root offset": plant_offset,
    "hold": plant_hold,
    "arm held": plant_world_hold,
    "cut": plant_cut,
}
"""Kind to the function that plants it."""


def plant_several(
    motion: Motion, kinds: list[str], onset: int, rng: np.random.Generator
) -> tuple[Motion, list[Planted]]:
    """Plant events of some kinds in equal parts of a motion, in this order; an event for which a
    part has no place is left out."""
    events = []
    ends = np.linspace(0, len(motion), len(kinds) + 1).astype(int)
    for kind, first, end in zip(kinds, ends[:-1], ends[1:], strict=True):
        try:
            motion, event = PLANTS[kind](motion, slice(int(first), int(end)), rng, onset, "")
        except NoPlaceError:
            continue
        events.append(event)
    return motion, events


def turn_joint(motion: Motion, event: Planted, vector: np.ndarray, in_parent: bool) -> Motion:
    """The motion with the joint of an event turned by a rotation vector (3,), times the share of
    the event, in its parent's frame or in its own."""
    turn = from_vector(share_of(event)[:, None] * vector)
    column = index_of(motion, event.joint)
    rotations = motion.rotations.copy()
    true = rotations[event.stretch, column]
    rotations[event.stretch, column] = product(turn, true) if in_parent else product(true, turn)
    return replace(motion, rotations=rotations)


def mean_distance(motion: Motion, truth: Motion, event: Planted) -> float:
    """The mean distance (m) of the joints that an event moves from their true positions, in its
    frames."""
    columns = [rig_of(motion).joints[column] for column in moved_joints(event.joint)]
    off = motion.at(event.stretch).positions(columns) - truth.at(event.stretch).positions(columns)
    return float(np.linalg.norm(off, axis=-1).mean())


def share_of(event: Planted) -> np.ndarray:
    """The share of an event in its frames, (n,)."""
    frames = np.arange(event.last + 1 - event.first)
    from_end = np.minimum(frames, frames[::-1])
    u = np.minimum((from_end + 1) / (event.onset + 1), 1.0)
    return u * u * (3 - 2 * u)


def index_of(motion: Motion, joint: str) -> int:
    """The index of one of the twenty joints in the rig of a motion."""
    return int(rig_of(motion).joints[JOINTS.index(joint)])


def moved_joints(joint: str) -> list[int]:
    """Which of the twenty joints a rotation of a joint moves; all for the hips or the body."""
    if joint not in JOINTS[1:]:
        return list(range(len(JOINTS)))
    moved = [JOINTS.index(joint)]
    for column, parent in enumerate(PARENTS):
        if parent in moved:
            moved.append(column)
    return moved[1:] or moved


def _draw_stretch(
    motion: Motion,
    frames: slice,
    seconds: tuple[float, float],
    onset: int,
    rng: np.random.Generator,
) -> tuple[int, int]:
    """The first and the last frame of an event, with both onsets; longer than drawn where they
    would overlap."""
    room = frames.stop - frames.start - 2 * _margin(motion) - 2 * onset
    length = min(round(rng.uniform(*seconds) * motion.rate), room) + 2 * onset
    if length - 2 * onset < seconds[0] * motion.rate - 1:
        raise NoPlaceError("the frames are too few")
    first = _draw_first(motion, frames, length, rng)
    return first, first + length - 1


def _draw_first(motion: Motion, frames: slice, length: int, rng: np.random.Generator) -> int:
    """The first frame of an event of a length."""
    earliest = frames.start + _margin(motion)
    latest = frames.stop - _margin(motion) - length
    if latest < earliest:
        raise NoPlaceError("the frames are too few")
    return int(rng.integers(earliest, latest + 1))


def _margin(motion: Motion) -> int:
    return max(3, round(MARGIN_SECONDS * motion.rate))


def _direction(
    rng: np.random.Generator, weights: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> np.ndarray:
    """A random unit vector, (3,)."""
    vector = rng.normal(size=3) * weights
    return vector / np.linalg.norm(vector)


def _reach(motion: Motion, shoulder: int, elbow: int, wrist: int, target: np.ndarray) -> Motion:
    """The motion with an arm whose wrist reaches for a place, by cyclic coordinate descent.

    Elbow and shoulder are turned in turn so that the wrist lies on the line from the joint to the
    target. The elbow bends about any axis.
    """
    for _ in range(SWEEPS):
        for joint in (elbow, shoulder):
            positions, globals_ = motion.forward_kinematics([wrist])
            here = positions[:, wrist] - positions[:, joint]
            there = target - positions[:, joint]
            turn = _shortest_turn(here, there)
            parent = globals_[:, motion.skeleton.parents[joint]]
            rotations = motion.rotations.copy()
            turned = product(turn, globals_[:, joint])
            rotations[:, joint] = product(inverse(parent), turned)
            motion = replace(motion, rotations=rotations)
    return motion


def _shortest_turn(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The smallest rotations (F, 4) from directions to directions, (F, 3)."""
    a = start / np.maximum(np.linalg.norm(start, axis=1, keepdims=True), 1e-9)
    b = end / np.maximum(np.linalg.norm(end, axis=1, keepdims=True), 1e-9)
    w = 1 + np.sum(a * b, axis=1, keepdims=True)
    q = np.concatenate([np.cross(a, b), np.maximum(w, 1e-9)], axis=1)
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def clip_of(motion: Motion, rate: float, seconds: float) -> Motion | None:
    """The middle of a motion at a rate: frames are left out where that gives the rate, else the
    motion is resampled; None if it is shorter than 3 s or has a lower rate."""
    if rate > motion.rate + 1:
        return None
    first = max(0, int((motion.seconds - seconds) / 2 * motion.rate))
    middle = motion.at(slice(first, first + round(seconds * motion.rate)))
    clip = middle.resampled(rate)
    clip = replace(clip, rotations=clip.rotations.copy(), translations=clip.translations.copy())
    return clip if clip.seconds >= 3 else None
