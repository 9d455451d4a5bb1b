"""Measures of motion and baselines; `half_removed` and `reconstruction` have the tables that
`train` and `demo` print."""

from numpy_cae.evaluation.body import bone_length_error as bone_length_error
from numpy_cae.evaluation.body import jitter as jitter
from numpy_cae.evaluation.errors import angle_distance as angle_distance
from numpy_cae.evaluation.errors import position_error as position_error
from numpy_cae.evaluation.pca import PCA as PCA
from numpy_cae.evaluation.samples import diversity as diversity
from numpy_cae.evaluation.samples import nearest_distance as nearest_distance
from numpy_cae.evaluation.samples import nearest_neighbour_accuracy as nearest_neighbour_accuracy
from numpy_cae.motion.contacts import foot_sliding as foot_sliding

__all__ = [name for name in dir() if not name.startswith("_")]
