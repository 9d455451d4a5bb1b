"""One clip several times over, such as damaged, projected and true: for looking at."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.clips import Clips
from numpy_cae.motion import PARENTS, POSITIONS, features_to_positions
from numpy_cae.viz import Actor, save_figure, save_gif, strip_figure


@dataclass(frozen=True)
class Example:
    """Motions of the same number of frames, side by side.

    Parameters
    ----------
    motions : dict of label to (features, colour)
        Features (F, 63) on the mean skeleton.
    rate : float
        Frames a second.
    """

    motions: dict[str, tuple[np.ndarray, str]]
    rate: float

    @classmethod
    def of(cls, clips: Clips, window: int, motions: dict[str, tuple[np.ndarray, str]]) -> Example:
        """The real frames of one window of each of these stacks of windows."""
        real = clips.real[window]
        cut = {
            label: (clips.manifold.denormalise(x[window][real]), colour)
            for label, (x, colour) in motions.items()
        }
        return cls(cut, clips.manifold.rate)

    def save_strips(self, path: str | Path) -> None:
        """A strip of poses for each, seen from the body's left front, PNG."""
        actors = [
            Actor(features[:, POSITIONS].reshape(len(features), -1, 3), PARENTS, label, colour)
            for label, (features, colour) in self.motions.items()
        ]
        save_figure(strip_figure(actors, self.rate, azimuth=55.0), path)

    def save_gif(self, path: str | Path) -> None:
        """Side by side, on the paths that their velocities add up to."""
        actors = [
            Actor(features_to_positions(features), PARENTS, label, colour)
            for label, (features, colour) in self.motions.items()
        ]
        save_gif(actors, path, self.rate)
