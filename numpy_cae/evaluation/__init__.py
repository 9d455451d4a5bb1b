"""Measures of motion and baselines; `half_removed` and `reconstruction` have the tables that
`train` and `demo` print."""

from numpy_cae.evaluation.baselines import PCA
from numpy_cae.evaluation.measures import (
    angle_distance,
    diversity,
    jitter,
    nearest_distance,
    nearest_neighbour_accuracy,
    position_error,
)
from numpy_cae.motion.contacts import foot_sliding

__all__ = [name for name in dir() if not name.startswith("_")]
