"""Smoothing over time, each feature by itself."""

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import savgol_filter


def median(x: np.ndarray, length: int) -> np.ndarray:
    """The median of the `length` values, an odd number, around each value in time, of (…, T, C).

        y_t = median(x_{t-h}, …, x_{t+h}),    h = (length - 1) / 2

    It removes outliers and keeps edges where fewer than half of the values in reach are wrong.
    Beyond the ends the first and last values are repeated.
    """
    return median_filter(x, (1,) * (x.ndim - 2) + (length, 1), mode="nearest")


def savitzky_golay(x: np.ndarray, length: int, order: int) -> np.ndarray:
    """The polynomial fitted to the `length` values, an odd number, around each value of (…, T, C).

        y_t = π_t(t),    π_t = argmin_{π of degree ≤ order} Σ_{|s-t| ≤ h} (x_s - π(s))²

    Order 0 is the moving average. Near the ends the polynomial of the outermost `length` values
    is used.
    """
    return savgol_filter(x, length, order, axis=-2)
