"""Measures of motions and of methods, each defined once."""

from numpy_cae.measures.body import bone_length_error, foot_sliding, gait_frequency, jitter
from numpy_cae.measures.errors import angle_distance, position_error
from numpy_cae.measures.samples import diversity, nearest_distance, nearest_neighbour_accuracy
from numpy_cae.measures.validity import Validity, ValidityMeasure

__all__ = [
    "Validity",
    "ValidityMeasure",
    "angle_distance",
    "bone_length_error",
    "diversity",
    "foot_sliding",
    "gait_frequency",
    "jitter",
    "nearest_distance",
    "nearest_neighbour_accuracy",
    "position_error",
]
