"""Pooling by the mean of each pair of frames, which holden2015 does not use."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae import ops
from numpy_cae.ops.shapes import require_shape


def average_pool(x: np.ndarray) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """y[t] = (x[2t] + x[2t + 1]) / 2, each channel for itself.

    Both frames have the same influence, half each, so the pullback is `ops.unpool_even`:

        dL/dx[2t] = dL/dx[2t + 1] = dy[t] / 2

    Parameters
    ----------
    x : (B, T, C) array of float
        T is even.

    Returns
    -------
    y : (B, T/2, C) array
    pullback : dy -> dx

    Raises
    ------
    ValueError
        If x does not have three axes or T is odd.
    """
    require_shape("x", x, ("batch", "frames", "channels"))
    if x.shape[1] % 2 == 1:
        raise ValueError(f"x has shape {x.shape}, expected an even number of frames to pool")
    y = (x[:, 0::2] + x[:, 1::2]) / 2

    def pullback(dy: np.ndarray) -> np.ndarray:
        require_shape("dy", dy, y.shape)
        return ops.unpool_even(dy)[0]

    return y, pullback
