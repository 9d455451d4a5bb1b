"""Ways to say how unlike two motions are: equation 4 of holden2015, and what stands beside it.

Every way makes rows of numbers of a clip, one row or one for each of its windows; the distance of
two clips is the Euclidean distance of their nearest rows. Of signatures that is √G, which ranks
as G does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from numpy_cae.baselines import PCA
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold, hidden_units, signature
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.windows import cut_windows

EQUATION_4 = "G: min and max of the hidden units"
UNTRAINED = "the same of an untrained network"
EUCLIDEAN = "Euclidean distance of windows"
RAW_EXTREMES = "min and max of the features"
WHITENED = "min and max of 20 PCA numbers, whitened"
AXES, WINDOW_AXES = 20, 30


@dataclass(frozen=True)
class Distance:
    """One way to compare.

    Parameters
    ----------
    name : str
    rows : function
        From features (F, 63) of a clip to (n, d) numbers.
    """

    name: str
    rows: Callable[[np.ndarray], np.ndarray]

    def between(
        self, some: Sequence[np.ndarray], others: Sequence[np.ndarray] | None = None
    ) -> np.ndarray:
        """From each clip to each other one, features (F, 63), as (M, N) array of float64.

        Where no `others` are given, among themselves.
        """
        rows, first = self._stacked(some)
        columns, begin = (rows, first) if others is None else self._stacked(others)
        each = cdist(rows, columns)
        return np.minimum.reduceat(np.minimum.reduceat(each, first, axis=0), begin, axis=1)

    def _stacked(self, clips: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        parts = [self.rows(features) for features in clips]
        counts = [len(part) for part in parts]
        return np.concatenate(parts).astype(np.float64), np.cumsum([0, *counts[:-1]])


def equation_4(manifold: MotionManifold, name: str = EQUATION_4) -> Distance:
    """√G."""
    return Distance(name, lambda features: signature(hidden_units(manifold, features))[None])


def raw_extremes(manifold: MotionManifold) -> Distance:
    """The pooling of equation 4 without a network: of the features as the network is given them."""
    return Distance(RAW_EXTREMES, lambda features: signature(manifold.normalise(features))[None])


def euclidean(manifold: MotionManifold) -> Distance:
    """The paper's naive distance: window against window, frame by frame."""
    return Distance(EUCLIDEAN, lambda features: _windows(manifold, features))


def all_distances(
    manifold: MotionManifold, training: Sequence[np.ndarray], seed: int = 0
) -> list[Distance]:
    """Every way, what has to be fitted fitted on the features of training takes."""
    network = manifold.network
    return [
        equation_4(manifold),
        equation_4(untrained(manifold, seed), UNTRAINED),
        Distance(
            "mean of the hidden units",
            lambda features: hidden_units(manifold, features).mean(axis=0)[None],
        ),
        Distance(
            "hidden units of windows",
            lambda features: _flat(network.encode(raw_windows(manifold, features))),
        ),
        euclidean(manifold),
        raw_extremes(manifold),
        Distance(
            "mean of the features", lambda features: manifold.normalise(features).mean(axis=0)[None]
        ),
        *_of_pca(manifold, training),
    ]


def _of_pca(manifold: MotionManifold, training: Sequence[np.ndarray]) -> list[Distance]:
    """PCA on frames, pooled, as it is and with every axis as wide as the others; and on windows."""
    frames = np.concatenate([manifold.normalise(take) for take in training]).astype(np.float64)
    by_frame = PCA.fit(frames)
    axes = by_frame.axes[:AXES]
    spread = ((frames - by_frame.mean) @ axes.T).std(axis=0)
    windows = np.concatenate([_windows(manifold, take) for take in training])
    by_window = PCA.fit(windows.astype(np.float64))

    def numbers(features: np.ndarray) -> np.ndarray:
        return (manifold.normalise(features) - by_frame.mean) @ axes.T

    return [
        Distance(
            f"min and max of {AXES} PCA numbers",
            lambda features: signature(numbers(features))[None],
        ),
        Distance(WHITENED, lambda features: signature(numbers(features) / spread)[None]),
        Distance(
            f"{WINDOW_AXES} PCA numbers of windows",
            lambda features: (
                (_windows(manifold, features) - by_window.mean) @ by_window.axes[:WINDOW_AXES].T
            ),
        ),
    ]


def raw_windows(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    """A clip's features (F, 63) as the network was given them: (N, T, 63), normalised."""
    length, overlap = (manifold.settings[key] for key in ("window", "overlap"))
    return manifold.normalise(cut_windows(features, length, overlap)[0])


def _windows(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    return _flat(raw_windows(manifold, features))


def _flat(windows: np.ndarray) -> np.ndarray:
    return windows.reshape(len(windows), -1)


def untrained(manifold: MotionManifold, seed: int) -> MotionManifold:
    """The same manifold before it learned anything."""
    layers = manifold.network.layers
    taps, features, _ = layers[0].w.shape
    network = ConvAutoencoder(
        features, [layer.b.size for layer in layers], taps, layers[0].bound,
        np.random.default_rng(seed),
    )  # fmt: skip
    return MotionManifold(accelerate(network), manifold.mean_pose, manifold.scale, manifold.lengths)
