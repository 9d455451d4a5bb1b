"""Measures of motion and baselines; `half_removed` and `reconstruction` have the tables that
`train` and `demo` print."""

from numpy_cae.evaluation.errors import angle_distance, position_error
from numpy_cae.evaluation.pca import PCA

__all__ = [name for name in dir() if not name.startswith("_")]
