"""Every figure and table of both papers, one file each: run, table, picture."""

from numpy_cae.experiments.repair.figure_1 import Figure1, figure_1, typical
from numpy_cae.experiments.repair.half_zeroed import HalfZeroed, half_zeroed

__all__ = ["Figure1", "HalfZeroed", "figure_1", "half_zeroed", "typical"]
