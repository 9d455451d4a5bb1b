"""Motion files and rigs: a file of any format becomes a `Motion`, and a `Motion` a file.

`formats` turns text into a motion and back, `rigs` finds the twenty joints of a rig, `retarget`
converts between a rig and the twenty joints. `load_motion` puts a file into metres with Y up.
"""

from numpy_cae.mocap.coordinates import Coordinates as Coordinates
from numpy_cae.mocap.formats.bvh import read_bvh as read_bvh
from numpy_cae.mocap.formats.text_file import MotionFileError as MotionFileError
from numpy_cae.mocap.formats.write import write_bvh as write_bvh
from numpy_cae.mocap.load import find_motion_files as find_motion_files
from numpy_cae.mocap.load import load_angles as load_angles
from numpy_cae.mocap.load import load_body as load_body
from numpy_cae.mocap.load import load_motion as load_motion
from numpy_cae.mocap.retarget.body import body_of as body_of
from numpy_cae.mocap.retarget.body import body_positions as body_positions
from numpy_cae.mocap.retarget.to_angles import angles_of as angles_of
from numpy_cae.mocap.retarget.to_rig import retarget as retarget
from numpy_cae.mocap.rigs.recognise import find_joints as find_joints
from numpy_cae.mocap.rigs.recognise import rig_of as rig_of
from numpy_cae.mocap.rigs.rigs import UnknownRigError as UnknownRigError
from numpy_cae.mocap.rigs.rigs import read_mapping as read_mapping
from numpy_cae.mocap.save import save as save
from numpy_cae.mocap.windows import load_windows as load_windows

__all__ = [name for name in dir() if not name.startswith("_")]
