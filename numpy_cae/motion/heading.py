"""The heading of a body, an angle about Y that holden2015, section 4 removes from a motion, and the
rotation by such an angle: from Z towards X."""

import numpy as np

from numpy_cae.motion.joints import JOINTS

SMOOTHING_SECONDS = 1 / 3
"""Standard deviation of the Gaussian that smooths the heading: long enough to ignore the swing of
the shoulders within a step, short enough to keep a turn of the body."""


def heading(positions: np.ndarray, rate: float) -> np.ndarray:
    """The smoothed angle about Y of a body's forward direction, (sin θ, 0, cos θ).

    Forward is perpendicular to Y and to the line from the right hip and shoulder to the left ones.
    It is smoothed as a vector, so that frames in which the body leans far over, and the line is
    short along the floor, have little weight.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions of the twenty joints.
    rate : float
        Frames a second.

    Returns
    -------
    (F,) array of float64
        Radians, 0 facing +Z, growing towards +X, unwrapped: without jumps of 2π.
    """
    at = {joint: positions[:, index] for index, joint in enumerate(JOINTS)}
    across = at["left_shoulder"] - at["right_shoulder"] + at["left_hip"] - at["right_hip"]
    forward = np.cross(across, [0.0, 1.0, 0.0])
    smooth = smoothed(forward, SMOOTHING_SECONDS * rate)
    return np.unwrap(np.arctan2(smooth[:, 0], smooth[:, 2]))


def smoothed(values: np.ndarray, sigma: float) -> np.ndarray:
    """Values (F, C) smoothed along time by a Gaussian with a standard deviation of `sigma` frames,
    as `scipy.ndimage.gaussian_filter1d` does; the first and the last value are held."""
    radius = int(4 * sigma + 0.5)
    weights = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    held = np.pad(values, ((radius, radius), (0, 0)), mode="edge")
    columns = [np.convolve(column, weights / weights.sum(), "valid") for column in held.T]
    return np.stack(columns, axis=1)


def rotate_about_y(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """R(θ) v: vectors (…, 3) rotated about Y by angles in radians that broadcast to (…)."""
    floor = rotate_on_floor(vectors[..., [0, 2]], angles)
    y = np.broadcast_to(vectors[..., 1], floor.shape[:-1])
    return np.stack([floor[..., 0], y, floor[..., 1]], axis=-1)


def rotate_on_floor(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """The x and z of `rotate_about_y`: (x cos θ + z sin θ, z cos θ - x sin θ) of (…, 2)."""
    cos, sin = np.cos(angles), np.sin(angles)
    x, z = vectors[..., 0], vectors[..., 1]
    return np.stack([x * cos + z * sin, z * cos - x * sin], axis=-1)
