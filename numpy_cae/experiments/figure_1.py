"""Figure 1, left, of holden2015: a motion that lost half of its values (orange), its projection
onto the manifold (blue), and the truth (green)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.half_zeroed import P
from numpy_cae.manifold import MotionManifold
from numpy_cae.measures import position_error
from numpy_cae.motion import PARENTS, features_to_positions
from numpy_cae.training import zero_values
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, save_figure, save_gif, strip_figure


@dataclass(frozen=True)
class Figure1:
    """One clip three times, as world positions (F, 20, 3) in metres on the mean skeleton."""

    corrupted: np.ndarray
    projected: np.ndarray
    truth: np.ndarray
    rate: float
    corrupted_error: float
    projected_error: float

    def actors(self) -> list[Actor]:
        """For drawing, in the paper's colours; the errors are in the labels."""
        return [
            Actor(
                self.corrupted, PARENTS, f"corrupted, {self.corrupted_error:.1f} cm off", CORRUPTED
            ),
            Actor(
                self.projected, PARENTS, f"projected, {self.projected_error:.1f} cm off", PROJECTED
            ),
            Actor(self.truth, PARENTS, "truth", TRUTH),
        ]

    def save_picture(self, path: str | Path) -> None:
        """Three strips of poses, PNG."""
        save_figure(strip_figure(self.actors(), self.rate), path)

    def save_gif(self, path: str | Path) -> None:
        """The three side by side, moving."""
        save_gif(self.actors(), path, self.rate)


def figure_1(manifold: MotionManifold, take: np.ndarray, seed: int = 0) -> Figure1:
    """Zero half of the values of a take and project what is left.

    Parameters
    ----------
    manifold : MotionManifold
    take : (F, 20, 3) array of float
        World positions in metres at the manifold's rate.
    seed : int
        Of the lost values.
    """
    features, start = manifold.features(take)
    lost = zero_values(manifold.normalise(features), P, np.random.default_rng(seed))
    corrupted = manifold.denormalise(lost)
    projected = manifold.project(corrupted)
    return Figure1(
        features_to_positions(corrupted, start),
        features_to_positions(projected, start),
        features_to_positions(features, start),
        manifold.rate,
        position_error(corrupted, features),
        position_error(projected, features),
    )
