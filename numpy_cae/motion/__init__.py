"""A motion as arrays: skeletons, the features of holden2015 (63) and jang2018 (54), windows, clips.

This package knows no file and no rig: `numpy_cae.mocap` reads and writes files and finds the twenty
joints of a rig. Of the rest of the project it imports nothing.
"""

from numpy_cae.motion.angles import motion_of as motion_of
from numpy_cae.motion.angles import on_floor as on_floor
from numpy_cae.motion.clips import cut_clips as cut_clips
from numpy_cae.motion.clips import draw_clips as draw_clips
from numpy_cae.motion.features import POSITIONS as POSITIONS
from numpy_cae.motion.features import features_to_positions as features_to_positions
from numpy_cae.motion.features import joint_slice as joint_slice
from numpy_cae.motion.features import positions_to_features as positions_to_features
from numpy_cae.motion.joints import JOINTS as JOINTS
from numpy_cae.motion.joints import PARENTS as PARENTS
from numpy_cae.motion.lengths import bone_lengths as bone_lengths
from numpy_cae.motion.lengths import change_lengths as change_lengths
from numpy_cae.motion.motion import RATE as RATE
from numpy_cae.motion.motion import Motion as Motion
from numpy_cae.motion.motion import Note as Note
from numpy_cae.motion.motion import Skeleton as Skeleton
from numpy_cae.motion.windows import cut_windows as cut_windows

__all__ = [name for name in dir() if not name.startswith("_")]
