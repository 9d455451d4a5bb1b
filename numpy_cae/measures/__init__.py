"""Measures of motions and of methods, each defined once."""

from numpy_cae.measures.angle_distance import angle_distance
from numpy_cae.measures.bone_length_error import bone_length_error
from numpy_cae.measures.clip_distance import clip_distances, diversity, nearest_distance
from numpy_cae.measures.foot_sliding import foot_sliding
from numpy_cae.measures.gait_frequency import gait_frequency
from numpy_cae.measures.jitter import jitter
from numpy_cae.measures.joint_limits import JointLimits, bends, beyond_limits
from numpy_cae.measures.nearest_pose import NearestPose
from numpy_cae.measures.position_error import position_error
from numpy_cae.measures.two_sample import nearest_neighbour_accuracy
from numpy_cae.measures.validity import Validity, ValidityMeasure

__all__ = [
    "JointLimits",
    "NearestPose",
    "Validity",
    "ValidityMeasure",
    "angle_distance",
    "bends",
    "beyond_limits",
    "bone_length_error",
    "clip_distances",
    "diversity",
    "foot_sliding",
    "gait_frequency",
    "jitter",
    "nearest_distance",
    "nearest_neighbour_accuracy",
    "position_error",
]
