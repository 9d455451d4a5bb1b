"""Windows of takes in the network's own terms, and what is measured on them against the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.manifold import MotionManifold
from numpy_cae.measures import jitter, position_error
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.windows import LENGTH, OVERLAP, cut_windows


@dataclass(frozen=True)
class Clips:
    """The truth that repairs are measured against.

    Parameters
    ----------
    manifold : MotionManifold
        Whose mean skeleton and scale the windows are in.
    x : (N, T, 63) array of float32
        X: normalised windows, zero the mean pose.
    real : (N, T) array of bool
        Frames that count; False where a short take holds its last pose.
    """

    manifold: MotionManifold
    x: np.ndarray
    real: np.ndarray

    def __len__(self) -> int:
        return len(self.x)

    def error(self, x: np.ndarray, joint: str | None = None) -> float:
        """The `position_error` of windows, cm, over all joints or one."""
        features, truth = self.manifold.denormalise(x), self.manifold.denormalise(self.x)
        return position_error(features, truth, self.real, joint)

    def jitter(self, x: np.ndarray) -> float:
        """The `jitter` of windows, m/s², on the paths that their velocities add up to; each window
        counts by the accelerations that it has."""
        rate, features = self.manifold.rate, self.manifold.denormalise(x)
        clips = [window[real] for window, real in zip(features, self.real, strict=True)]
        clips = [clip for clip in clips if len(clip) >= 3]
        each = [jitter(features_to_positions(clip), rate) for clip in clips]
        return float(np.average(each, weights=[len(clip) - 2 for clip in clips]))

    def evenly(self, count: int) -> Clips:
        """At most so many of the windows, spread evenly over all."""
        chosen = np.linspace(0, len(self) - 1, min(count, len(self))).round().astype(int)
        return replace(self, x=self.x[chosen], real=self.real[chosen])


def clips_of(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> Clips:
    """Takes cut as the manifold's training cut them.

    Parameters
    ----------
    manifold : MotionManifold
    takes : sequence of (F, 20, 3) arrays of float
        World positions in metres at the manifold's rate.

    Raises
    ------
    ValueError
        If there are no takes.
    """
    if not takes:
        raise ValueError("there are no takes to cut into windows")
    length = manifold.settings.get("window", LENGTH)
    overlap = manifold.settings.get("overlap", OVERLAP)
    cut = [cut_windows(manifold.features(take)[0], length, overlap) for take in takes]
    windows = np.concatenate([windows for windows, _ in cut])
    return Clips(manifold, manifold.normalise(windows), np.concatenate([real for _, real in cut]))


def project(manifold: MotionManifold, x: np.ndarray, at_once: int = 64) -> np.ndarray:
    """Φ†(Φ(X)) of normalised windows (N, T, 63), a part at a time to spare memory."""
    parts = [x[start : start + at_once] for start in range(0, len(x), at_once)]
    return np.concatenate([manifold.network.project(part) for part in parts])
