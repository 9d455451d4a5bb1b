"""Motions given as features, side by side: as strips of poses and as an animation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.experiments.result import Animation
from numpy_cae.motion import PARENTS, POSITIONS, features_to_positions
from numpy_cae.viz import Actor, strip_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Motions = Mapping[str, tuple[np.ndarray, str]]
"""Label to features (F, 63) on the mean skeleton and a colour."""


def strips(motions: Motions, rate: float, azimuth: float = 55.0) -> Callable[[], Figure]:
    """A figure with a strip of poses for each motion, all in the body's own heading."""
    actors = [
        Actor(local_positions(features), PARENTS, label, colour)
        for label, (features, colour) in motions.items()
    ]
    return lambda: strip_figure(actors, rate, azimuth=azimuth)


def animated(
    motions: Motions, rate: float, azimuth: float = 40.0, seconds: float = 10.0
) -> Animation:
    """The motions side by side, on the paths that their velocities add up to."""
    actors = [
        Actor(features_to_positions(features), PARENTS, label, colour)
        for label, (features, colour) in motions.items()
    ]
    return Animation(actors, rate, azimuth, seconds)


def local_positions(features: np.ndarray) -> np.ndarray:
    """The joints of features (F, 63) in the body's own heading, (F, 20, 3) in metres."""
    return features[:, POSITIONS].reshape(len(features), -1, 3)
