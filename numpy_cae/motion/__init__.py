"""Motion files in, skeletons, the 63 features of holden2015 section 4, windows, and back to files.

This room stands alone: it knows nothing of networks.
"""

from numpy_cae.motion.error import MotionFileError
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton

__all__ = ["Motion", "MotionFileError", "Skeleton"]
