"""Motions to draw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import cycle

import numpy as np

from numpy_cae.motion import JOINTS, PARENTS, Motion
from numpy_cae.motion.features import features_to_positions, local_positions
from numpy_cae.visible import visible
from numpy_cae.viz.colours import CORRUPTED, PLAIN, PROJECTED, TRUTH


@dataclass(frozen=True, eq=False)
class Actor:
    """A motion to draw: F frames of J joints.

    The viewer shows the names and colours joints by `moved`.
    """

    positions: np.ndarray  # (F, J, 3), world positions in metres
    parents: tuple[int, ...]
    label: str = ""
    colour: str = PLAIN
    names: tuple[str, ...] = ()  # of the joints
    moved: np.ndarray | None = None  # (F, J), distances as `measure_distances` has them, metres

    def __post_init__(self) -> None:
        object.__setattr__(self, "label", visible(self.label))
        object.__setattr__(self, "names", tuple(map(visible, self.names)))


def measure_distances(actor: Actor, first: Actor) -> Actor:
    """The motion with the distances of its joints from those of `first`, in metres: the first joint
    in the world, each other one from the first; unchanged if joints or frames are not the same."""
    same = actor.names == first.names and actor.positions.shape == first.positions.shape
    if actor is first or not same:
        return actor
    change = actor.positions - first.positions
    change[:, 1:] -= change[:, :1]
    return replace(actor, moved=np.linalg.norm(change, axis=-1))


def before_and_after(
    before: Motion,
    after: Motion,
    joints: Sequence[int],
    labels: Sequence[str] = ("before", "after"),
) -> list[Actor]:
    """A motion and the repaired one, as the twenty joints of their rig; frames at the start that
    were cut off are drawn as they were."""
    positions = before.positions(joints)
    repaired = positions.copy()
    repaired[len(before) - len(after) :] = after.positions(joints)
    first = Actor(positions, PARENTS, labels[0], CORRUPTED, JOINTS)
    return [first, measure_distances(Actor(repaired, PARENTS, labels[1], PROJECTED, JOINTS), first)]


_RIGID = 0.01
"""A bone's length changes by less than this (m). The hips have no bone to a root on the
floor, from which they move away."""


def motion_actor(
    motion: Motion, label: str = "", colour: str = PLAIN, rate: float | None = None
) -> Actor:
    """A motion of any rig, in its own frames or at another rate.

    A root from which the body moves away (an origin on the floor) is left out.
    """
    resampled = motion.resampled(rate or motion.rate)
    positions = resampled.positions()
    parents = resampled.skeleton.parents
    first = 0
    while parents.count(first) == 1:
        bone = np.linalg.norm(positions[:, first] - positions[:, first + 1], axis=-1)
        if parents[first + 1] != first or np.ptp(bone) < _RIGID:
            break
        first += 1
    parents = tuple(max(parent - first, -1) for parent in parents[first:])
    names = tuple(resampled.skeleton.names[first:])
    return Actor(positions[:, first:], parents, label, colour, names)


def side_by_side(
    motions: Sequence[Motion], labels: Sequence[str], compared: bool = False
) -> list[Actor]:
    """Motions of any rigs at the rate of the first, each in a colour of its own.

    They are coloured by their distances from the first only if `compared` says that they are
    versions of one motion: two motions of one rig may have as many frames by chance.
    """
    colours = [PROJECTED] if len(motions) == 1 else [CORRUPTED, PROJECTED, TRUTH, PLAIN]
    rate = motions[0].rate
    actors = [
        motion_actor(motion, label, colour, rate)
        for motion, label, colour in zip(motions, labels, cycle(colours), strict=False)
    ]
    if compared:
        return [measure_distances(actor, actors[0]) for actor in actors]
    return actors


Motions = Mapping[str, tuple[np.ndarray, str]]
"""Label to features (F, 63) at thirty frames a second and a colour."""


def world_actors(motions: Motions, placed=features_to_positions) -> list[Actor]:
    """Motions in the world, on the paths that follow from their velocities."""
    return [
        Actor(placed(features), PARENTS, label, colour, JOINTS)
        for label, (features, colour) in motions.items()
    ]


def local_actors(motions: Motions) -> list[Actor]:
    """Motions in the frame of the body, without path and heading, for strips of poses."""
    return world_actors(motions, local_positions)
