"""Motion files, skeletons, the features of holden2015 (63) and jang2018 (54), windows and clips.

Of the rest of the project this package imports only the modules `errors` and `atomic_write`.
"""

from numpy_cae.motion.angles import motion_of as motion_of
from numpy_cae.motion.angles import on_floor as on_floor
from numpy_cae.motion.clips import cut_clips as cut_clips
from numpy_cae.motion.clips import draw_clips as draw_clips
from numpy_cae.motion.features import POSITIONS as POSITIONS
from numpy_cae.motion.features import features_to_positions as features_to_positions
from numpy_cae.motion.features import joint_slice as joint_slice
from numpy_cae.motion.features import positions_to_features as positions_to_features
from numpy_cae.motion.formats.bvh import read_bvh as read_bvh
from numpy_cae.motion.formats.text_file import MotionFileError as MotionFileError
from numpy_cae.motion.formats.write import write_bvh as write_bvh
from numpy_cae.motion.joints import JOINTS as JOINTS
from numpy_cae.motion.joints import PARENTS as PARENTS
from numpy_cae.motion.lengths import bone_lengths as bone_lengths
from numpy_cae.motion.lengths import change_lengths as change_lengths
from numpy_cae.motion.motion import RATE as RATE
from numpy_cae.motion.motion import Motion as Motion
from numpy_cae.motion.read.coordinates import Coordinates as Coordinates
from numpy_cae.motion.read.load import find_motion_files as find_motion_files
from numpy_cae.motion.read.load import load_angles as load_angles
from numpy_cae.motion.read.load import load_body as load_body
from numpy_cae.motion.read.load import load_motion as load_motion
from numpy_cae.motion.read.windows import load_windows as load_windows
from numpy_cae.motion.retarget.body import body_of as body_of
from numpy_cae.motion.retarget.rigs import UnknownRigError as UnknownRigError
from numpy_cae.motion.retarget.rigs import body_positions as body_positions
from numpy_cae.motion.retarget.rigs import find_joints as find_joints
from numpy_cae.motion.retarget.rigs import read_mapping as read_mapping
from numpy_cae.motion.retarget.to_angles import angles_of as angles_of
from numpy_cae.motion.retarget.to_rig import retarget as retarget
from numpy_cae.motion.skeleton import Skeleton as Skeleton
from numpy_cae.motion.windows import cut_windows as cut_windows

__all__ = [name for name in dir() if not name.startswith("_")]
