"""Distances between motions: equation 4 of holden2015, and others to compare it with.

Each distance makes rows of numbers of a clip, one row or one for each of its windows; the distance
of two clips is the Euclidean distance of their nearest rows. For signatures that is √G, which ranks
as G does.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from numpy_cae.evaluation import PCA
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold, hidden_units, signature
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.windows import cut_windows

EQUATION_4 = "G: min and max of the hidden units"
UNTRAINED = "the same of an untrained network"
EUCLIDEAN = "Euclidean distance of windows"
RAW_EXTREMES = "min and max of the features"
WHITENED = "min and max of 20 PCA numbers, whitened"
AXES = 20


@dataclass(frozen=True)
class Distance:
    """A distance between clips; `rows` maps the features (F, 63) of a clip to (n, d) numbers."""

    name: str
    rows: Callable[[np.ndarray], np.ndarray]

    def between(
        self, some: Sequence[np.ndarray], others: Sequence[np.ndarray] | None = None
    ) -> np.ndarray:
        """From each of M clips to each of N others, features (F, 63), as (M, N) float64.

        Without `others`, between the clips themselves.
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
    """Equation 4 without a network: minimum and maximum of the normalised features."""
    return Distance(RAW_EXTREMES, lambda features: signature(manifold.normalise(features))[None])


def euclidean(manifold: MotionManifold) -> Distance:
    """The paper's naive distance: between windows, frame by frame."""

    def windows(features: np.ndarray) -> np.ndarray:
        overlap = manifold.settings["overlap"]
        x = manifold.normalise(cut_windows(features, manifold.window, overlap)[0])
        return x.reshape(len(x), -1)

    return Distance(EUCLIDEAN, windows)


def all_distances(
    manifold: MotionManifold, training: Sequence[np.ndarray], seed: int = 0
) -> list[Distance]:
    """All of them; PCA is fitted to the features of training takes."""
    return [
        equation_4(manifold),
        equation_4(untrained(manifold, seed), UNTRAINED),
        euclidean(manifold),
        raw_extremes(manifold),
        whitened_extremes(manifold, training),
    ]


def whitened_extremes(manifold: MotionManifold, training: Sequence[np.ndarray]) -> Distance:
    """Equation 4 of PCA on frames, whose axes are scaled to unit variance."""
    frames = np.concatenate([manifold.normalise(take) for take in training]).astype(np.float64)
    by_frame = PCA.fit(frames)
    axes = by_frame.axes[:AXES]
    spread = ((frames - by_frame.mean) @ axes.T).std(axis=0)

    def rows(features: np.ndarray) -> np.ndarray:
        return signature((manifold.normalise(features) - by_frame.mean) @ axes.T / spread)[None]

    return Distance(WHITENED, rows)


def untrained(manifold: MotionManifold, seed: int) -> MotionManifold:
    """The same manifold with the initial weights of a seed."""
    layers = manifold.network.layers
    taps, features, _ = layers[0].w.shape
    filters, rng = [layer.b.size for layer in layers], np.random.default_rng(seed)
    network = ConvAutoencoder(features, filters, taps, layers[0].bound, rng)
    return MotionManifold(accelerate(network), manifold.mean_pose, manifold.scale, manifold.lengths)
