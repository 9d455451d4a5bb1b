"""The frequency of strides, two steps each, by autocorrelation.

    s_t = (left ankle - right ankle) · forward,    r_l = mean_t (s_t - s̄)(s_{t+l} - s̄)

The first peak of r after it was negative is one stride.
"""

import numpy as np

from numpy_cae.motion.joints import JOINTS

MIN_FREQUENCY = 0.4
"""Strides a second; anything slower is standing."""


def gait_frequency(positions: np.ndarray, rate: float) -> float:
    """Strides a second.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions of the twenty joints.
    rate : float
        Frames a second.

    Returns
    -------
    float
        nan where the legs do not alternate or the clip is shorter than a stride.
    """
    lead = _lead(np.asarray(positions, dtype=np.float64))
    lead = lead - lead.mean()
    frames = len(lead)
    # The longest lag leaves a quarter of the clip to compare.
    lags = np.arange(min(int(rate / MIN_FREQUENCY) + 2, frames * 3 // 4 + 2))
    products = np.array([np.mean(lead[: frames - lag] * lead[lag:]) for lag in lags])
    below = np.flatnonzero(products < 0)
    if len(below) == 0:
        return float("nan")
    start = below[0]
    peaks = [
        lag
        for lag in range(start + 1, len(lags) - 1)
        if products[lag] > 0 and products[lag - 1] < products[lag] >= products[lag + 1]
    ]
    if not peaks:
        return float("nan")
    peak = peaks[0]
    # The peak of a parabola through three values lies between frames.
    left, top, right = products[peak - 1 : peak + 2]
    shift = 0.5 * (left - right) / (left - 2 * top + right)
    return float(rate / (peak + shift))


def _lead(positions: np.ndarray) -> np.ndarray:
    """How far the left ankle is in front of the right along the hips' direction, (F,), metres."""
    joint = {name: positions[:, JOINTS.index(name)] for name in
             ("left_hip", "right_hip", "left_ankle", "right_ankle")}  # fmt: skip
    across = joint["left_hip"] - joint["right_hip"]
    forward = np.stack([-across[:, 2], np.zeros(len(across)), across[:, 0]], axis=1)
    forward /= np.maximum(np.linalg.norm(forward, axis=1, keepdims=True), 1e-9)
    return np.sum((joint["left_ankle"] - joint["right_ankle"]) * forward, axis=1)
