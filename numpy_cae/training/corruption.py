"""The corruption of denoising autoencoding: X to X_c (holden2015, section 6)."""

from __future__ import annotations

import numpy as np


def zero_values(x: np.ndarray, p: float, rng: np.random.Generator) -> np.ndarray:
    """X_c: each value of x set to zero with probability p, by itself.

    Zero is the mean pose, since that has been subtracted.

    Parameters
    ----------
    x : array of float, any shape
    p : float
        Between 0 and 1.
    rng : numpy.random.Generator

    Returns
    -------
    array of the shape and dtype of x
    """
    if not 0 <= p <= 1:
        raise ValueError(f"p is {p}, expected a probability between 0 and 1")
    return np.where(rng.random(x.shape, dtype=np.float32) < p, x.dtype.type(0), x)
