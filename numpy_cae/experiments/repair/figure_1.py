"""Figure 1, left, of holden2015: a motion that lost half of its values (orange), its projection
onto the manifold (blue), and the truth (green)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.repair.half_zeroed import P
from numpy_cae.manifold import MotionManifold
from numpy_cae.measures import position_error
from numpy_cae.motion import PARENTS, POSITIONS, RootTransform, features_to_positions
from numpy_cae.training import zero_values
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, save_figure, save_gif, strip_figure

COLOURS = {"corrupted": CORRUPTED, "projected": PROJECTED, "truth": TRUTH}


@dataclass(frozen=True)
class Figure1:
    """One clip three times, as features (F, 63) on the mean skeleton, and the place it starts."""

    corrupted: np.ndarray
    projected: np.ndarray
    truth: np.ndarray
    start: RootTransform
    rate: float

    def positions(self, name: str) -> np.ndarray:
        """World positions (F, 20, 3) in metres of "corrupted", "projected" or "truth"."""
        return features_to_positions(getattr(self, name), self.start)

    def error(self, name: str) -> float:
        """Its `position_error` against the truth, cm."""
        return position_error(getattr(self, name), self.truth)

    def save_picture(self, path: str | Path) -> None:
        """Three strips of poses, each seen from its body's left front, PNG."""
        local = [
            getattr(self, name)[:, POSITIONS].reshape(len(self.truth), -1, 3) for name in COLOURS
        ]
        save_figure(strip_figure(self._actors(local), self.rate, azimuth=55.0), path)

    def save_gif(self, path: str | Path) -> None:
        """The three side by side, on the paths that their velocities add up to."""
        save_gif(self._actors([self.positions(name) for name in COLOURS]), path, self.rate)

    def _actors(self, motions: list[np.ndarray]) -> list[Actor]:
        labels = [
            name if name == "truth" else f"{name}, {self.error(name):.1f} cm off"
            for name in COLOURS
        ]
        return [
            Actor(positions, PARENTS, label, colour)
            for positions, label, colour in zip(motions, labels, COLOURS.values(), strict=True)
        ]


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
    return Figure1(corrupted, manifold.project(corrupted), features, start, manifold.rate)


def typical(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> np.ndarray:
    """The take in the middle of all by how far it strays from the mean pose: neither the easiest
    nor the hardest, whatever the network makes of it."""

    def strays(take: np.ndarray) -> float:
        features, _ = manifold.features(take)
        return position_error(np.broadcast_to(manifold.mean_pose, features.shape), features)

    return sorted(takes, key=strays)[len(takes) // 2]
