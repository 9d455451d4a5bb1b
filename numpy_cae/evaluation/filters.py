"""Smoothing over time, each feature by itself."""

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import savgol_filter


def median(x: np.ndarray, length: int) -> np.ndarray:
    """The median of the `length` values around each value in time.

        y_t = median(x_{t-h}, …, x_{t+h}),    h = (length - 1) / 2

    It removes outliers and keeps edges where fewer than half of the values in reach are wrong.

    Parameters
    ----------
    x : (…, T, C) array of float
    length : int
        Frames, odd. Beyond the ends the first and last values are repeated.

    Returns
    -------
    array of the shape and dtype of x
    """
    return median_filter(x, (1,) * (x.ndim - 2) + (length, 1), mode="nearest")


def savitzky_golay(x: np.ndarray, length: int, order: int) -> np.ndarray:
    """The value of the polynomial fitted to the `length` values around each value in time.

        y_t = π_t(t),    π_t = argmin_{π of degree ≤ order} Σ_{|s-t| ≤ h} (x_s - π(s))²

    Order 0 is the moving average. Near the ends the polynomial of the outermost `length` values
    is used.

    Parameters
    ----------
    x : (…, T, C) array of float
    length : int
        Frames, odd, above `order` and at most T.
    order : int

    Returns
    -------
    array of the shape of x
    """
    return savgol_filter(x, length, order, axis=-2)
