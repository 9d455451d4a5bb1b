"""Motion files in, skeletons, the 63 features of holden2015 section 4, windows, and back to files.

This room stands alone: it knows nothing of networks.
"""

from numpy_cae.motion.error import MotionFileError
from numpy_cae.motion.load import find_motion_files, load_motion
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.read_amc import read_amc
from numpy_cae.motion.read_asf import read_asf
from numpy_cae.motion.read_bvh import read_bvh
from numpy_cae.motion.skeleton import Skeleton
from numpy_cae.motion.write_bvh import write_bvh

__all__ = [
    "Motion",
    "MotionFileError",
    "Skeleton",
    "find_motion_files",
    "load_motion",
    "read_amc",
    "read_asf",
    "read_bvh",
    "write_bvh",
]
