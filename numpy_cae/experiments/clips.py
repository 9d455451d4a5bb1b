"""Windows of takes in the network's own terms, and what is measured on them against the truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.blind import project_shifted
from numpy_cae.measures import jitter, position_error
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.windows import LENGTH, cut_windows

NETWORK, ENDS_HELD = "the network", "the network, ends held"
ALL_SHIFTS = "the network, ends held, all shifts"
"""What `project` and `project_ends_held` (once, and the mean over all shifts) are called in
tables."""


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
    take : (N,) array of int
        Number of the take that a window is of.
    """

    manifold: MotionManifold
    x: np.ndarray
    real: np.ndarray
    take: np.ndarray

    def __len__(self) -> int:
        return len(self.x)

    def error(self, x: np.ndarray, joint: str | None = None) -> float:
        """The `position_error` of windows, cm, over all joints or one."""
        gap = (x - self.x) / self.manifold.scale  # the mean pose is in both
        return position_error(gap, np.zeros(gap.shape[-1]), self.real, joint)

    def jitter(self, x: np.ndarray) -> float:
        """The `jitter` of windows, m/s², on the paths that their velocities add up to; each window
        counts by the accelerations that it has."""
        rate, features = self.manifold.rate, self.manifold.denormalise(x)
        clips = [window[real] for window, real in zip(features, self.real, strict=True)]
        clips = [clip for clip in clips if len(clip) >= 3]
        each = [jitter(features_to_positions(clip), rate) for clip in clips]
        return float(np.average(each, weights=[len(clip) - 2 for clip in clips]))

    def each(
        self, change: Callable[[np.ndarray], np.ndarray], x: np.ndarray | None = None
    ) -> np.ndarray:
        """Every window, or those of x, changed by itself as features (T, 63) in metres."""
        features = self.manifold.denormalise(self.x if x is None else x)
        return self.manifold.normalise(np.stack([change(window) for window in features]))

    def typical(self) -> int:
        """Number of the window in the middle of all by how far it strays from the mean pose; of
        those with the most real frames."""
        frames = np.count_nonzero(self.real, axis=1)
        strays = np.mean(np.square(self.x), axis=(1, 2))
        long = np.flatnonzero(frames == frames.max())
        return int(long[np.argsort(strays[long])[len(long) // 2]])

    def later(self, frames: int) -> Clips:
        """The same truth so many frames later; what comes before it does not count."""
        real = np.roll(self.real, frames, axis=1) & self.real
        real[:, :frames] = False
        return replace(self, x=np.roll(self.x, frames, axis=1), real=real)

    def evenly(self, count: int) -> Clips:
        """At most so many of the windows, spread evenly over all."""
        chosen = np.linspace(0, len(self) - 1, min(count, len(self))).round().astype(int)
        return self._chosen(chosen, self.real)

    def where(self, windows: np.ndarray, frames: np.ndarray) -> Clips:
        """The windows that are chosen, (N,) bool, and of them the frames, (N, T) bool, counted."""
        return self._chosen(windows, self.real & frames)

    def _chosen(self, windows: np.ndarray, real: np.ndarray) -> Clips:
        return replace(self, x=self.x[windows], real=real[windows], take=self.take[windows])


def clips_of(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> Clips:
    """Takes cut into windows of the manifold's length that overlap by half, as the paper's do,
    whatever the overlap in training: tables of two networks are of the same windows.

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
    cut = [cut_windows(manifold.features(take)[0], length, length // 2) for take in takes]
    windows = np.concatenate([windows for windows, _ in cut])
    take = np.repeat(np.arange(len(cut)), [len(windows) for windows, _ in cut])
    real = np.concatenate([real for _, real in cut])
    return Clips(manifold, manifold.normalise(windows), real, take)


def project(manifold: MotionManifold, x: np.ndarray) -> np.ndarray:
    """Φ†(Φ(X)) of normalised windows (N, T, 63) just as they are, zeros beyond their ends."""
    return project_shifted(manifold.network, x)


def project_ends_held(manifold: MotionManifold, x: np.ndarray, shifts: int = 1) -> np.ndarray:
    """Φ†(Φ(X)) of windows whose first and last frames are held beyond their ends, as
    `MotionManifold.project` does with a clip; the mean over so many shifts."""
    projected = project_shifted(manifold.network, hold_ends(manifold, x), shifts)
    return cut_ends(manifold, projected, x.shape[1])


def hold_ends(manifold: MotionManifold, x: np.ndarray) -> np.ndarray:
    """Windows (N, T, C) continued on both sides as far as the network sees."""
    reach = manifold.reach
    more = -(x.shape[1] + 2 * reach) % manifold.network.frames_per_unit
    return np.pad(x, ((0, 0), (reach, reach + more), (0, 0)), mode="edge")


def cut_ends(manifold: MotionManifold, x: np.ndarray, frames: int) -> np.ndarray:
    """What `hold_ends` made of windows of so many frames, without the continuation."""
    return x[:, manifold.reach : manifold.reach + frames]
