"""Motions to be drawn, and the colours of holden2015, figure 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.motion.features import POSITIONS, features_to_positions
from numpy_cae.motion.joints import PARENTS
from numpy_cae.motion.motion import Motion

CORRUPTED = "#e8833a"
PROJECTED = "#2f6db5"
TRUTH = "#3f9a4b"
PLAIN = "#444444"


@dataclass(frozen=True)
class Actor:
    """A motion to be drawn; the viewer shows names, colours `moved` and has `damaged` in its
    timeline."""

    positions: np.ndarray  # (F, J, 3), world positions in metres
    parents: tuple[int, ...]
    label: str = ""
    colour: str = PLAIN
    names: tuple[str, ...] = ()  # of the joints
    moved: np.ndarray | None = None  # (F, J) metres of each joint from the first motion's
    damaged: np.ndarray | None = None  # (F, J) bool

    def at_frames(self, frames: np.ndarray) -> Actor:
        """The same motion with other frames, given by their indices."""
        chosen = {
            name: value[frames]
            for name in ("positions", "moved", "damaged")
            if (value := getattr(self, name)) is not None
        }
        return replace(self, **chosen)


_RIGID = 0.01
"""Metres by which a bone's length may change. A root that stays behind has no bone to the hips."""


def motion_actor(motion: Motion, label: str = "", colour: str = PLAIN, rate: float = 30.0) -> Actor:
    """A motion of any rig, at `rate` or at its own rate where that is lower.

    A root from which the body moves away (an origin on the floor) is left out.
    """
    drawn = motion.resampled(min(rate, motion.rate))
    positions, parents = drawn.positions(), drawn.skeleton.parents
    first = 0
    while parents.count(first) == 1:
        bone = np.linalg.norm(positions[:, first] - positions[:, first + 1], axis=-1)
        if parents[first + 1] != first or np.ptp(bone) < _RIGID:
            break
        first += 1
    kept = tuple(max(parent - first, -1) for parent in parents[first:])
    return Actor(positions[:, first:], kept, label, colour, tuple(drawn.skeleton.names[first:]))


Motions = Mapping[str, tuple[np.ndarray, str]]
"""Label to features (F, 63) and a colour."""


def world_actors(motions: Motions) -> list[Actor]:
    """Motions on the paths that their velocities add up to."""
    return [
        Actor(features_to_positions(features), PARENTS, label, colour)
        for label, (features, colour) in motions.items()
    ]


def local_actors(motions: Motions) -> list[Actor]:
    """Motions in the body's own heading, for strips of poses."""
    return [
        Actor(features[:, POSITIONS].reshape(len(features), -1, 3), PARENTS, label, colour)
        for label, (features, colour) in motions.items()
    ]
