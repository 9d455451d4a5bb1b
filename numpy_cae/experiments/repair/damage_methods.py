"""Simple methods that repair a damaged motion in its rig: filters, and two with the mask given."""

from collections.abc import Callable

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import butter, savgol_filter, sosfiltfilt

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.linear_denoiser import TAPS, contexts
from numpy_cae.experiments.material import LabelledTake, evenly, features_of
from numpy_cae.manifold import MotionManifold, fill
from numpy_cae.manifold.repair import Holes
from numpy_cae.manifold.smooth import filter_motion
from numpy_cae.motion import POSITIONS, Motion
from numpy_cae.motion.retarget.body import Body

PCA_TAKES, EXPLAINED = 60, 0.95
"""PCA is fitted to every third frame of at most PCA_TAKES takes, with as many axes as explain the
share EXPLAINED of the variance."""

FILTERS: dict[str, Callable[[np.ndarray, float], np.ndarray]] = {
    "Savitzky-Golay, 0.3 s": lambda x, rate: savgol_filter(x, _frames(0.3, rate), 2, axis=0),
    "Savitzky-Golay, 0.7 s": lambda x, rate: savgol_filter(x, _frames(0.7, rate), 2, axis=0),
    "Butterworth, 6 Hz": lambda x, rate: _butterworth(x, 6.0, rate),
    "Butterworth, 3 Hz": lambda x, rate: _butterworth(x, 3.0, rate),
    "median, 0.2 s": lambda x, rate: median_filter(x, (_frames(0.2, rate), 1), mode="nearest"),
}
"""Name to a function of curves (F, C) and their frames a second."""


def _frames(seconds: float, rate: float) -> int:
    return 2 * round(seconds * rate / 2) + 1


def _butterworth(x: np.ndarray, cut_off: float, rate: float) -> np.ndarray:
    """Of second order, applied forwards and backwards, so that it does not delay."""
    return sosfiltfilt(butter(2, cut_off, fs=rate, output="sos"), x, axis=0)


def filtered(motion: Motion, name: str) -> Motion:
    """The motion with its curves of translations and rotations (quaternions) filtered."""

    def smooth(curves: np.ndarray) -> np.ndarray:
        return FILTERS[name](curves.reshape(len(curves), -1), motion.rate).reshape(curves.shape)

    return filter_motion(motion, smooth)


Filling = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Of features (F, 63), a spline where they are missing, and a mask (F, 20)."""


def filled(body: Body, mask: np.ndarray, filling: Filling) -> Motion:
    """The body's motion with the joints of a mask (frames, 20) filled in."""
    holes = Holes(body, mask)
    return holes.filled(filling(holes.features, holes.mask)).motion


def spline(manifold: MotionManifold) -> Filling:
    """PCHIP of the features."""
    return lambda features, missing: fill(manifold, features, missing, repeats=0)


def pca(manifold: MotionManifold, takes: list[LabelledTake]) -> Filling:
    """PCA of the 15 frames around each frame: the missing values are the most likely ones."""

    def rows(features: np.ndarray) -> np.ndarray:
        return contexts(manifold.normalise(features)[None], TAPS)[0]

    some = [rows(features)[::3] for features in features_of(manifold, evenly(takes, PCA_TAKES))]
    fitted = PCA.fit(np.concatenate(some).astype(np.float64))
    explained = np.cumsum(fitted.variances) / fitted.variances.sum()
    size = int(np.searchsorted(explained, EXPLAINED)) + 1

    def fill_in(features: np.ndarray, missing: np.ndarray) -> np.ndarray:
        known = np.ones(features.shape, bool)
        known[:, POSITIONS] = ~np.repeat(missing, 3, axis=1)
        frames = np.flatnonzero(missing.any(axis=1))
        sure = contexts(known[None], TAPS)[0][frames]
        found = fitted.fill(rows(features)[frames], sure, size)
        middle = np.split(found, TAPS, axis=1)[TAPS // 2]
        result = features.copy()
        result[frames] = manifold.denormalise(middle)
        return np.where(known, features, result)

    return fill_in
