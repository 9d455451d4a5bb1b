"""How unlike two motions are: holden2015, section 7, "Motion Comparison", equation 4.

    G(X_0, X_1) = ‖max_i Φ(X_0) - max_i Φ(X_1)‖² + ‖min_i Φ(X_0) - min_i Φ(X_1)‖²

i counts the frames of the hidden units. Since only the largest and the smallest value of each unit
are kept, when something happens no longer matters, nor how long the clip is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.distance import cdist

from numpy_cae.manifold.motion_manifold import MotionManifold


def hidden_units(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    """Φ(X) of a clip of any length: the hidden units of its own frames.

    The clip is continued as `MotionManifold.project` does it, its first and its last frame held as
    far as a unit sees, so that nothing is drawn to the mean pose at its ends. Units that stand on
    held frames alone are left out again: they are of a motion that did not happen. The pooling grid
    begins with the clip, so that not even the unit at its end sees beyond what is held.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        At least one frame.

    Returns
    -------
    (⌈F/8⌉, k) array of float, within [-1, 1]

    Raises
    ------
    ValueError
        If there are no frames.
    """
    if len(features) == 0:
        raise ValueError("features have no frames to encode")
    unit = manifold.network.frames_per_unit
    own = -(-len(features) // unit)
    before = -(-manifold.reach // unit)
    after = before * unit + own * unit - len(features)
    held = ((before * unit, after), (0, 0))
    whole = np.pad(manifold.normalise(features), held, mode="edge")
    return manifold.network.encode(whole[None])[0, before : before + own]


def signature(series: np.ndarray) -> np.ndarray:
    """max_i and min_i of a time series (i, k), one after the other: (2k,).

    Of the hidden units it is what equation 4 compares. Of anything else over time it is what a
    sensible person would try instead.
    """
    return np.concatenate([series.max(axis=0), series.min(axis=0)])


def G(units_0: np.ndarray, units_1: np.ndarray) -> float:
    """Equation 4 as it is written, of the hidden units (i, k) and (j, k) of two motions."""
    largest = units_0.max(axis=0) - units_1.max(axis=0)
    smallest = units_0.min(axis=0) - units_1.min(axis=0)
    return float(np.sum(largest**2, dtype=np.float64) + np.sum(smallest**2, dtype=np.float64))


def distance_matrix(
    signatures: Sequence[np.ndarray], others: Sequence[np.ndarray] | None = None
) -> np.ndarray:
    """G of every motion and every other, from their signatures (2k,).

    The two squared norms of equation 4 are one, of the signatures' difference.

    Parameters
    ----------
    signatures : sequence of M arrays (2k,)
    others : sequence of N arrays (2k,), optional
        The same motions where None.

    Returns
    -------
    (M, N) array of float64
    """
    rows = np.asarray(signatures, dtype=np.float64)
    columns = rows if others is None else np.asarray(others, dtype=np.float64)
    return cdist(rows, columns, "sqeuclidean")
