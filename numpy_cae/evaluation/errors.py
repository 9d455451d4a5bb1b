"""Errors of a motion compared with the true one."""

import numpy as np

from numpy_cae.motion.angle_table import ANGLES
from numpy_cae.motion.features import POSITIONS, joint_slice


def position_error(features: np.ndarray, truth: np.ndarray, joint: str | None = None) -> float:
    """100 · √ mean((q̂ - q)²), centimetres, over the coordinates of all joints or of one.

    The 60 position features are relative to the body's position on the floor and its heading, so
    that drift of the integrated path does not hide errors of the pose.

    Parameters
    ----------
    features, truth : (…, F, 63) arrays of float
        In metres.
    joint : str, optional
        The only joint to count, such as "left_wrist".
    """
    counted = POSITIONS if joint is None else joint_slice(joint)
    gap = (np.asarray(features) - truth)[..., counted]
    return float(100 * np.sqrt(np.mean(np.square(gap, dtype=np.float64))))


def angle_distance(numbers: np.ndarray, truth: np.ndarray) -> float:
    """mean over frames of ‖θ̂ - θ‖, over the 51 angles of a frame, in radians.

    Parameters
    ----------
    numbers, truth : (…, 54) arrays of float
        Not standardised. The root's translation is left out.
    """
    gap = (np.asarray(numbers, dtype=np.float64) - truth)[..., ANGLES]
    return float(np.linalg.norm(gap, axis=-1).mean())
