"""Interpolation between known values over time: easier than repair, where the known values are not
given.
"""

import numpy as np


def interpolate_linearly(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Linear interpolation of each feature between its known values.

        x̂_t = x_a + (t - a) / (b - a) · (x_b - x_a),    a ≤ t ≤ b the known frames around t

    Before the first known value and after the last, that value is repeated; a feature without known
    values is left unchanged.

    Parameters
    ----------
    x : (…, T, C) array of float
        Unknown values are ignored.
    known : array of bool of the same shape

    Returns
    -------
    array of the shape and dtype of x
    """
    filled = x.copy()
    frames = np.arange(x.shape[-2])
    for index in np.ndindex(x.shape[:-2]):
        for feature in range(x.shape[-1]):
            series = (*index, slice(None), feature)
            sure = known[series]
            if sure.any():
                filled[series] = np.interp(frames, frames[sure], x[series][sure])
    return filled
