"""Motion files, skeletons, the features of holden2015 (63) and jang2018 (54), windows and clips.

Of the rest of the project this package imports only the modules `errors` and `atomic_write`.
"""

from numpy_cae.motion.angles import motion_of, on_floor
from numpy_cae.motion.clips import cut_clips, draw_clips
from numpy_cae.motion.features import (
    POSITIONS,
    features_to_positions,
    joint_slice,
    positions_to_features,
)
from numpy_cae.motion.formats.bvh import read_bvh
from numpy_cae.motion.formats.text_file import MotionFileError
from numpy_cae.motion.formats.write import write_bvh
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import RATE, Motion
from numpy_cae.motion.read.coordinates import Coordinates
from numpy_cae.motion.read.load import find_motion_files, load_angles, load_body, load_motion
from numpy_cae.motion.read.windows import load_windows
from numpy_cae.motion.retarget.body import body_of
from numpy_cae.motion.retarget.rigs import (
    UnknownRigError,
    body_positions,
    find_joints,
    read_mapping,
)
from numpy_cae.motion.retarget.to_angles import angles_of
from numpy_cae.motion.retarget.to_rig import retarget
from numpy_cae.motion.skeleton import Skeleton
from numpy_cae.motion.windows import cut_windows

__all__ = [
    "JOINTS",
    "PARENTS",
    "POSITIONS",
    "RATE",
    "Coordinates",
    "Motion",
    "MotionFileError",
    "Skeleton",
    "UnknownRigError",
    "angles_of",
    "body_of",
    "body_positions",
    "bone_lengths",
    "change_lengths",
    "cut_clips",
    "cut_windows",
    "draw_clips",
    "features_to_positions",
    "find_joints",
    "find_motion_files",
    "joint_slice",
    "load_angles",
    "load_body",
    "load_motion",
    "load_windows",
    "motion_of",
    "on_floor",
    "positions_to_features",
    "read_bvh",
    "read_mapping",
    "retarget",
    "write_bvh",
]
