"""Motion files and rigs: a file of any format becomes a `Motion`, and a `Motion` a file.

`formats` turns text into a motion and back, `rigs` finds the twenty joints of a rig, `retarget`
converts between a rig and the twenty joints. `load_motion` puts a file into metres with Y up.
"""

from numpy_cae.mocap.bodies import load_windows
from numpy_cae.mocap.file_motion import save
from numpy_cae.mocap.formats.read_bvh import read_bvh
from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.mocap.formats.write_bvh import require_bvh, write_bvh
from numpy_cae.mocap.load import find_motion_files, load_angles, load_body, load_motion
from numpy_cae.mocap.retargeting.body import Body, body_of, body_positions, hold_first_pose
from numpy_cae.mocap.retargeting.to_angles import angles_of
from numpy_cae.mocap.retargeting.to_rig import retarget
from numpy_cae.mocap.rigs.recognise import find_joints, rig_of
from numpy_cae.mocap.rigs.rigs import UnknownRigError, read_mapping

__all__ = [
    "Body",
    "MotionFileError",
    "UnknownRigError",
    "angles_of",
    "body_of",
    "body_positions",
    "find_joints",
    "find_motion_files",
    "hold_first_pose",
    "load_angles",
    "load_body",
    "load_motion",
    "load_windows",
    "read_bvh",
    "read_mapping",
    "require_bvh",
    "retarget",
    "rig_of",
    "save",
    "write_bvh",
]
