"""Distance between two motions: holden2015, section 7, "Motion Comparison", equation 4.

    G(X_0, X_1) = ‖max_i Φ(X_0) - max_i Φ(X_1)‖² + ‖min_i Φ(X_0) - min_i Φ(X_1)‖²

i counts the frames of the hidden units. Only the largest and the smallest value of each unit are
kept, so neither the time of an event nor the length of a clip matters.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.distance import cdist

from numpy_cae.manifold.motion_manifold import MotionManifold


def hidden_units(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    """Φ(X) of a clip of one frame or more, (F, 63) to (⌈F/8⌉, k), without units of the padding.

    As in `MotionManifold.encode` the first and last frame are held, but here the pooling grid
    begins with the clip and the units before and after it are removed.
    """
    if len(features) == 0:
        raise ValueError("features have no frames to encode")
    unit = manifold.network.frames_per_unit
    own = -(-len(features) // unit)
    before = -(-manifold.reach // unit)
    after = before * unit + own * unit - len(features)
    padded = np.pad(manifold.normalise(features), ((before * unit, after), (0, 0)), mode="edge")
    return manifold.network.encode(padded[None])[0, before : before + own]


def signature(series: np.ndarray) -> np.ndarray:
    """max_i and min_i of a time series (i, k), concatenated: (2k,)."""
    return np.concatenate([series.max(axis=0), series.min(axis=0)])


def G(units_0: np.ndarray, units_1: np.ndarray) -> float:
    """Equation 4, of the hidden units (i, k) and (j, k) of two motions."""
    largest = units_0.max(axis=0) - units_1.max(axis=0)
    smallest = units_0.min(axis=0) - units_1.min(axis=0)
    return float(np.sum(largest**2, dtype=np.float64) + np.sum(smallest**2, dtype=np.float64))


def distance_matrix(
    signatures: Sequence[np.ndarray], others: Sequence[np.ndarray] | None = None
) -> np.ndarray:
    """G between M motions and N others, (M, N) of float64, from their signatures (2k,).

    The others are the same motions where None. The two squared norms of equation 4 together are
    the squared norm of the difference of the signatures.
    """
    rows = np.asarray(signatures, dtype=np.float64)
    columns = rows if others is None else np.asarray(others, dtype=np.float64)
    return cdist(rows, columns, "sqeuclidean")
