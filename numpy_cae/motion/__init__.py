"""A motion as arrays: skeletons, the features of holden2015 (63) and jang2018 (54), windows, clips.

This package knows no file and no rig: `numpy_cae.mocap` reads and writes files and finds the twenty
joints of a rig. It imports nothing of the rest of the project.
"""

from numpy_cae.motion.angles import ANGLE_RATE, AngleSequence, motion_of, on_floor
from numpy_cae.motion.clips import CLIP, cut_clips, draw_clips
from numpy_cae.motion.features import (
    POSITIONS,
    bone_lengths,
    change_lengths,
    features_to_positions,
    joint_slice,
    positions_to_features,
)
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.motion import RATE, Motion, Note, Skeleton
from numpy_cae.motion.windows import LENGTH, OVERLAP, cut_windows

__all__ = [
    "ANGLE_RATE",
    "CLIP",
    "JOINTS",
    "LENGTH",
    "OVERLAP",
    "PARENTS",
    "POSITIONS",
    "RATE",
    "AngleSequence",
    "Motion",
    "Note",
    "Skeleton",
    "bone_lengths",
    "change_lengths",
    "cut_clips",
    "cut_windows",
    "draw_clips",
    "features_to_positions",
    "joint_slice",
    "motion_of",
    "on_floor",
    "positions_to_features",
]
