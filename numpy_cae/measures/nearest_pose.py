"""The distance of a pose from the nearest real pose."""

import numpy as np
from scipy.spatial import cKDTree

from numpy_cae.motion.features import POSITIONS

MAX_POSES = 12_000
"""Real poses kept; neighbouring frames are nearly equal."""


class NearestPose:
    """The distance to the nearest of a set of real poses.

        d_t = 100 · min_i √ mean_k (q_{t,k} - q_{i,k})²

    over the 60 position features, local to the body's place on the floor and its heading: the
    smallest `position_error` of each frame to a real pose, in centimetres.

    Parameters
    ----------
    features : (N, 63) array of float
        Real poses, on the same bones as the poses to measure. At most `MAX_POSES` of them, evenly
        spread, are kept.
    """

    def __init__(self, features: np.ndarray):
        step = -(-len(features) // MAX_POSES)
        self._tree = cKDTree(np.asarray(features, dtype=np.float64)[::step, POSITIONS])

    def distances(self, features: np.ndarray) -> np.ndarray:
        """d of every frame (F, 63), in centimetres, (F,)."""
        poses = np.asarray(features, dtype=np.float64)[:, POSITIONS]
        distance, _ = self._tree.query(poses)
        return 100 * distance / np.sqrt(poses.shape[1])

    def mean_distance(self, features: np.ndarray) -> float:
        """The mean of `distances` over the frames, in centimetres."""
        return float(self.distances(features).mean())
