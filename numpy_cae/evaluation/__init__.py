"""Measures of motions and of methods, and simple methods to compare the networks with."""

from numpy_cae.evaluation.body import bone_length_error, foot_sliding, jitter
from numpy_cae.evaluation.errors import angle_distance, position_error
from numpy_cae.evaluation.interpolation import interpolate_linearly
from numpy_cae.evaluation.linear_denoiser import LinearDenoiser, Moments
from numpy_cae.evaluation.pca import PCA
from numpy_cae.evaluation.samples import diversity, nearest_distance, nearest_neighbour_accuracy
from numpy_cae.evaluation.validity import Validity, ValidityMeasure

__all__ = [
    "PCA",
    "LinearDenoiser",
    "Moments",
    "Validity",
    "ValidityMeasure",
    "angle_distance",
    "bone_length_error",
    "diversity",
    "foot_sliding",
    "interpolate_linearly",
    "jitter",
    "nearest_distance",
    "nearest_neighbour_accuracy",
    "position_error",
]
