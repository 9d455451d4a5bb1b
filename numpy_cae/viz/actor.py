"""Motions to be drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from numpy_cae.motion.features import POSITIONS, features_to_positions
from numpy_cae.motion.joints import PARENTS
from numpy_cae.viz.colours import PLAIN


@dataclass(frozen=True)
class Actor:
    """A motion to be drawn.

    Parameters
    ----------
    positions : (F, J, 3) array of float
        World positions in metres.
    parents : tuple of J int
    label : str
    colour : str
    """

    positions: np.ndarray
    parents: tuple[int, ...]
    label: str = ""
    colour: str = PLAIN


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
