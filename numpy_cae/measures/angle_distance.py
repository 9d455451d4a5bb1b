"""jang2018's measure: "Euclidean distance was used as a metric in the joint angle space"."""

import numpy as np

from numpy_cae.motion.angle_table import ANGLES


def angle_distance(numbers: np.ndarray, truth: np.ndarray) -> float:
    """mean over frames of ‖θ̂ - θ‖, over the 51 angles of a frame, in radians.

    Parameters
    ----------
    numbers, truth : (…, 54) arrays of float
        Not standardised. The root's translation is left out.
    """
    gap = (np.asarray(numbers, dtype=np.float64) - truth)[..., ANGLES]
    return float(np.linalg.norm(gap, axis=-1).mean())
