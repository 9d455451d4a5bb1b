"""Normalised windows of takes, and the errors of repaired windows against them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.evaluation.measures import position_error
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion.windows import cut_windows


@dataclass(frozen=True)
class Clips:
    """The true windows with which repaired windows are compared."""

    manifold: MotionManifold  # gives the mean skeleton and the scale
    x: np.ndarray  # X: normalised windows (N, T, 63); zero is the mean pose
    real: np.ndarray  # (N, T) bool: frames that count, not those that pad a short take
    take: np.ndarray  # (N,) number of the take of each window

    def __len__(self) -> int:
        return len(self.x)

    def error(self, x: np.ndarray, joint: str | None = None) -> float:
        """The `position_error` of windows, cm, over all joints or one."""
        gap = (x[self.real] - self.x[self.real]) / self.manifold.scale  # the mean pose cancels
        return position_error(gap, np.zeros(gap.shape[-1]), joint=joint)

    def evenly(self, count: int) -> Clips:
        """At most `count` of the windows, evenly spaced."""
        chosen = np.linspace(0, len(self) - 1, min(count, len(self))).round().astype(int)
        return replace(self, x=self.x[chosen], real=self.real[chosen], take=self.take[chosen])


def clips_of(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> Clips:
    """Cut world positions (F, 20, 3) of takes into windows of the manifold's length.

    The windows overlap by half, whatever the overlap in training, so that two networks are measured
    on the same windows. ValueError if there are no takes.
    """
    if not takes:
        raise ValueError("there are no takes to cut into windows")
    length = manifold.window
    cut = [cut_windows(manifold.features(take)[0], length, length // 2) for take in takes]
    numbers = np.repeat(np.arange(len(cut)), [len(windows) for windows, _ in cut])
    x = np.concatenate([manifold.normalise(windows) for windows, _ in cut])
    return Clips(manifold, x, np.concatenate([real for _, real in cut]), numbers)
