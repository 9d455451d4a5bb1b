"""How unlike two motions are by the shortest way along the manifold between them: holden2015's
abstract, "computing similarity between motions using geodesic distance along the manifold".

A path joins motions of one length. So clips are cut into windows, and the distance of two clips is
the length of the geodesic between the two windows, one of each, whose projections are nearest.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.distance import cdist

from numpy_cae.manifold.geodesic import BETWEEN_POINTS, BETWEEN_STEPS, geodesic_lengths
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.windows import LENGTH, cut_windows


def geodesic_matrix(
    manifold: MotionManifold,
    clips: Sequence[np.ndarray],
    others: Sequence[np.ndarray] | None = None,
    points: int = BETWEEN_POINTS,
    steps: int = BETWEEN_STEPS,
) -> np.ndarray:
    """The geodesic distance of every clip and every other, root mean square in the network's scale.

    Parameters
    ----------
    manifold : MotionManifold
    clips : sequence of M (F, 63) arrays of float
        Features; what is shorter than a window holds its last pose.
    others : sequence of N such, optional
        The same clips where None; each pair is then measured once.
    points, steps : int
        As `geodesic` takes them; two points are the line through the space of motions.

    Returns
    -------
    (M, N) array of float64
    """
    rows = [_encoded(manifold, clip) for clip in clips]
    columns = rows if others is None else [_encoded(manifold, clip) for clip in others]
    pairs = [
        (m, n) for m in range(len(rows)) for n in range(len(columns)) if others is not None or m < n
    ]
    ends = [_nearest(*rows[m], *columns[n]) for m, n in pairs]
    distances = np.zeros((len(rows), len(columns)))
    if pairs:
        first, second = (np.stack(each) for each in zip(*ends, strict=True))
        distances[tuple(np.transpose(pairs))] = geodesic_lengths(
            manifold, first, second, points, steps
        )
    return distances + distances.T if others is None else distances


def _encoded(manifold: MotionManifold, features: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Hidden units of a clip's windows, and what they decode to in one row each."""
    length = manifold.settings.get("window", LENGTH)
    windows, _ = cut_windows(features, length, length // 2)
    units = manifold.network.encode(manifold.normalise(windows))
    return units, manifold.network.decode(units).reshape(len(units), -1)


def _nearest(
    units: np.ndarray, decoded: np.ndarray, other_units: np.ndarray, other_decoded: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    pair = int(np.argmin(cdist(decoded, other_decoded)))
    return units[pair // len(other_units)], other_units[pair % len(other_units)]
