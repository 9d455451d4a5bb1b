"""Motion files in, skeletons, the 63 features of holden2015 section 4, windows, and back to files.

This room stands alone: it knows nothing of networks.
"""

from numpy_cae.motion.body import at_rate_of, body_of, load_body
from numpy_cae.motion.error import MotionFileError
from numpy_cae.motion.features import (
    FEATURES,
    POSITIONS,
    TURN,
    VELOCITY,
    Place,
    features_to_positions,
    joint_slice,
    positions_to_features,
)
from numpy_cae.motion.fit import fit_motion
from numpy_cae.motion.follow import follow
from numpy_cae.motion.joints import (
    JOINTS,
    PARENTS,
    UnknownRigError,
    body_positions,
    find_joints,
    read_mapping,
)
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.load import find_motion_files, load_motion
from numpy_cae.motion.load_windows import FileWindows, load_windows
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.read_amc import read_amc
from numpy_cae.motion.read_asf import read_asf
from numpy_cae.motion.read_bvh import read_bvh
from numpy_cae.motion.skeleton import Skeleton
from numpy_cae.motion.windows import cut_windows, hold_last_pose
from numpy_cae.motion.write_acclaim import write_acclaim, write_amc, write_asf
from numpy_cae.motion.write_bvh import write_bvh

__all__ = [
    "FEATURES",
    "JOINTS",
    "PARENTS",
    "POSITIONS",
    "TURN",
    "VELOCITY",
    "FileWindows",
    "Motion",
    "MotionFileError",
    "Place",
    "Skeleton",
    "UnknownRigError",
    "at_rate_of",
    "body_of",
    "body_positions",
    "bone_lengths",
    "change_lengths",
    "cut_windows",
    "features_to_positions",
    "find_joints",
    "find_motion_files",
    "fit_motion",
    "follow",
    "hold_last_pose",
    "joint_slice",
    "load_body",
    "load_motion",
    "load_windows",
    "positions_to_features",
    "read_amc",
    "read_asf",
    "read_bvh",
    "read_mapping",
    "write_acclaim",
    "write_amc",
    "write_asf",
    "write_bvh",
]
