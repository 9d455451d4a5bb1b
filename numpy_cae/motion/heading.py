"""Where a body faces: the angle about Y that holden2015, section 4 removes from a motion."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from numpy_cae.motion.joints import JOINTS

SMOOTHING_SECONDS = 1 / 3
"""Spread of the Gaussian that smooths the heading: slow enough not to follow the swing of the
shoulders within a step, quick enough to follow a turn."""


def heading(positions: np.ndarray, rate: float) -> np.ndarray:
    """The smoothed angle about Y of a body's forward direction, (sin θ, 0, cos θ).

    Forward is square to the line from the right hip and shoulder to the left ones and to Y. Its
    direction is smoothed as a vector, so that moments in which the body leans far over, and the
    line has little length along the floor, count little.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions of the twenty joints.
    rate : float
        Frames a second.

    Returns
    -------
    (F,) array of float64
        Radians, 0 facing +Z, growing towards +X, unwrapped: never a jump of a whole turn.
    """
    at = {joint: positions[:, index] for index, joint in enumerate(JOINTS)}
    across = at["left_shoulder"] - at["right_shoulder"] + at["left_hip"] - at["right_hip"]
    forward = np.cross(across, [0.0, 1.0, 0.0])
    sigma = SMOOTHING_SECONDS * rate
    smooth = gaussian_filter1d(forward, sigma, axis=0, mode="nearest")
    return np.unwrap(np.arctan2(smooth[:, 0], smooth[:, 2]))
