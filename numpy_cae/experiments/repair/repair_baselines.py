"""What a sensible person would repair windows with, each at the best setting that it can have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from numpy_cae.baselines import PCA, median, savitzky_golay
from numpy_cae.experiments.clips import Clips
from numpy_cae.experiments.split import Split

PCA_ON_FRAMES, PCA_ON_WINDOWS = "PCA on frames", "PCA on windows"
MEDIAN, SAVITZKY_GOLAY = "median filter", "Savitzky-Golay filter"

Repair = Callable[[np.ndarray, object], np.ndarray]

AXES = (1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 63, 100, 150, 200, 300, 450)
LENGTHS = (3, 5, 7, 9, 15)
POLYNOMIALS = tuple(
    (length, order) for length in (5, 7, 9, 11, 15, 21, 31, 45, 61) for order in (0, 2)
)


@dataclass(frozen=True)
class Contender:
    """A way to repair windows, with one thing to set.

    Parameters
    ----------
    name : str
    settings : tuple
        What can be chosen.
    trial : (windows, setting) -> windows
        For choosing: has seen nothing of `Split.choosing`.
    repair : (windows, setting) -> windows
        For measuring: fitted to all training windows.
    """

    name: str
    settings: tuple
    trial: Repair
    repair: Repair

    def best(self, damaged: np.ndarray, truth: Clips, joint: str | None = None) -> object:
        """The setting of least error, at one joint or all, on these damaged windows."""
        return min(
            self.settings, key=lambda setting: truth.error(self.trial(damaged, setting), joint)
        )


def contenders_of(split: Split) -> list[Contender]:
    """All of them."""
    return [
        median_filter(),
        savitzky_golay_filter(split.testing.x.shape[1]),
        pca_on_frames(split),
        pca_on_windows(split),
    ]


def pca_on_frames(split: Split) -> Contender:
    """PCA of poses: knows nothing of time."""
    return _pca(PCA_ON_FRAMES, split, split.training.x.shape[-1])


def pca_on_windows(split: Split) -> Contender:
    """PCA of whole windows: poses and their course."""
    return _pca(PCA_ON_WINDOWS, split, split.training.x[0].size)


def median_filter() -> Contender:
    """Knows nothing of bodies."""
    return Contender(MEDIAN, LENGTHS, median, median)


def savitzky_golay_filter(frames: int) -> Contender:
    """Knows nothing of bodies; for windows of so many frames. Order 0 is the moving average."""

    def repair(x: np.ndarray, setting: tuple[int, int]) -> np.ndarray:
        return savitzky_golay(x, *setting)

    short = tuple(setting for setting in POLYNOMIALS if setting[0] <= frames)
    return Contender(SAVITZKY_GOLAY, short, repair, repair)


def _pca(name: str, split: Split, numbers: int) -> Contender:
    def fitted(clips: Clips) -> tuple[int, Repair]:
        pca = PCA.fit(clips.x.reshape(-1, numbers))

        def repair(x: np.ndarray, size: object) -> np.ndarray:
            return pca.project(x.reshape(-1, numbers), size).reshape(x.shape)

        return len(pca.axes), repair

    (largest, trial), (_, repair) = fitted(split.fitting), fitted(split.training)
    sizes = tuple(size for size in AXES if size < largest)
    return Contender(name, (*sizes, largest), trial, repair)
