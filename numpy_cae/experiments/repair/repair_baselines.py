"""Simple methods that repair windows, each with its best setting."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from numpy_cae.baselines import PCA, median, savitzky_golay
from numpy_cae.experiments.clips import Clips, Split

PCA_ON_FRAMES, PCA_ON_WINDOWS = "PCA on frames", "PCA on windows"
MEDIAN, SAVITZKY_GOLAY = "median filter", "Savitzky-Golay filter"
AXES = (1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 63, 100, 150, 200, 300, 450)
LENGTHS = (3, 5, 7, 9, 15)
POLYNOMIALS = tuple(
    (length, order) for length in (5, 7, 9, 11, 15, 21, 31, 45, 61) for order in (0, 2)
)
Repair = Callable[[np.ndarray, object], np.ndarray]


@dataclass(frozen=True)
class RepairBaseline:
    """A method with one setting.

    `trial` is fitted to `Split.fitting`, for choosing one of the settings on `Split.choosing`;
    `repair` to all training windows, for measuring. Both map windows and a setting to windows.
    """

    name: str
    settings: tuple
    trial: Repair
    repair: Repair

    def best(self, damaged: np.ndarray, truth: Clips) -> object:
        """The setting of least error on these damaged windows."""
        return min(self.settings, key=lambda setting: truth.error(self.trial(damaged, setting)))


def repair_baselines(split: Split) -> list[RepairBaseline]:
    """All of them. A polynomial of order 0 is the moving average."""

    def smoothed(x: np.ndarray, setting: tuple[int, int]) -> np.ndarray:
        return savitzky_golay(x, *setting)

    frames = split.testing.x.shape[1]
    short = tuple(setting for setting in POLYNOMIALS if setting[0] <= frames)
    return [
        RepairBaseline(MEDIAN, LENGTHS, median, median),
        RepairBaseline(SAVITZKY_GOLAY, short, smoothed, smoothed),
        _pca(PCA_ON_FRAMES, split, split.training.x.shape[-1]),
        pca_on_windows(split),
    ]


def pca_on_windows(split: Split) -> RepairBaseline:
    """PCA of whole windows."""
    return _pca(PCA_ON_WINDOWS, split, split.training.x[0].size)


def _pca(name: str, split: Split, numbers: int) -> RepairBaseline:
    """PCA of rows of so many numbers."""
    parts = split.fitting, split.training
    trial, final = (PCA.fit(clips.x.reshape(-1, numbers)) for clips in parts)
    sizes = tuple(size for size in AXES if size < len(trial.axes))
    return RepairBaseline(name, (*sizes, len(trial.axes)), trial.project, final.project)
