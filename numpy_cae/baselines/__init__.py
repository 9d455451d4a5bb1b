"""Simple methods to compare the networks with."""

from numpy_cae.baselines.filters import median, savitzky_golay
from numpy_cae.baselines.interpolation import interpolate_cubically, interpolate_linearly
from numpy_cae.baselines.linear_denoiser import LinearDenoiser, Moments
from numpy_cae.baselines.pca import PCA

__all__ = [
    "PCA",
    "LinearDenoiser",
    "Moments",
    "interpolate_cubically",
    "interpolate_linearly",
    "median",
    "savitzky_golay",
]
