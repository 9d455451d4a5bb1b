"""Distance between two motions: holden2015, section 7, "Motion Comparison", equation 4.

    G(X_0, X_1) = ‖max_i Φ(X_0) - max_i Φ(X_1)‖² + ‖min_i Φ(X_0) - min_i Φ(X_1)‖²

i counts the hidden frames, the time steps of Y. Only the largest and the smallest value of each
unit (channel of Y) are kept, so neither the time of an event nor the length of a clip matters.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold


def hidden_units(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    """Φ(X) of a clip of one frame or more, (F, 63) to (⌈F/8⌉, k).

    As in `MotionManifold.encode` the first and last frame are repeated, but here the padding is a
    whole number of pooling cells; hidden frames that belong to it are removed. Input is not
    rescaled as for a network that `rescales`.
    """
    if len(features) == 0:
        raise ValueError("features have no frames to encode")
    cell = manifold.network.stride
    own = -(-len(features) // cell)
    before = -(-manifold.reach // cell)
    after = before * cell + own * cell - len(features)
    padded = np.pad(manifold.normalise(features), ((before * cell, after), (0, 0)), mode="edge")
    return manifold.network.encode(padded[None])[0, before : before + own]


def signature(series: np.ndarray) -> np.ndarray:
    """max_i and min_i of a time series (i, k), concatenated: (2k,)."""
    return np.concatenate([series.max(axis=0), series.min(axis=0)])


def G(y_0: np.ndarray, y_1: np.ndarray) -> float:
    """Equation 4, of the hidden units (i, k) and (j, k) of two motions."""
    largest = y_0.max(axis=0) - y_1.max(axis=0)
    smallest = y_0.min(axis=0) - y_1.min(axis=0)
    return float(np.sum(largest**2, dtype=np.float64) + np.sum(smallest**2, dtype=np.float64))


def distance_matrix(
    signatures: Sequence[np.ndarray], others: Sequence[np.ndarray] | None = None
) -> np.ndarray:
    """`G` of all pairs of M motions and N others, (M, N) of float64, from signatures (2k,).

    The others are the same motions where None. The two squared norms of equation 4 together are
    the squared norm of the difference of the signatures.
    """
    rows = np.asarray(signatures, dtype=np.float64)
    columns = rows if others is None else np.asarray(others, dtype=np.float64)
    return np.array([np.sum((row - columns) ** 2, axis=-1) for row in rows])
