"""The corruption of denoising autoencoding: X to X_c (holden2015, section 6)."""

from __future__ import annotations

import numpy as np


def zero_values(x: np.ndarray, p: float | np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """X_c: each value of x set to zero with probability p, independently; zero is the mean pose.

    p is between 0 and 1, or an array of such numbers that broadcasts to x, which has any shape.
    """
    if not np.all((0 <= np.asarray(p)) & (np.asarray(p) <= 1)):
        raise ValueError(f"p is {p}, expected a probability between 0 and 1")
    return np.where(rng.random(x.shape, dtype=np.float32) < p, x.dtype.type(0), x)


def corrupt(
    x: np.ndarray, zeroed: float | tuple[float, float], rescaled: bool, rng: np.random.Generator
) -> np.ndarray:
    """X_c of a batch of windows, with one p or a p for each window.

        X_c = zero_values(X, p),   p ~ U(zeroed),   and where rescaled   X_c / (1 - p)

    `zeroed` is p, or the two numbers that each window's p is drawn between; below 1 where rescaled.
    Zeroing values with probability p multiplies their expected sum by 1 - p. Dividing by 1 - p
    restores it, whatever p is, so the filters need not be fitted to one p.
    """
    p: float | np.ndarray
    if isinstance(zeroed, (int, float)):
        p = zeroed
    else:
        p = rng.uniform(*zeroed, size=(len(x), 1, 1)).astype(x.dtype)
    corrupted = zero_values(x, p, rng)
    return corrupted / (1 - p) if rescaled else corrupted
