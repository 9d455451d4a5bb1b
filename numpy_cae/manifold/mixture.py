"""A mean of the network's projection and of a linear map, with the weight that suits each window.

Neither is better everywhere: a network is better on motions like those that it learned from, a
linear map of 15 frames often on others. Of a window X_c, of which a share p̂ of the values was
removed, the estimate is

    P(X_c) = a Φ†(Φ(X̂)) + (1 - a) L(X̂),    X̂ = X_c / (1 - p̂)

and a is found without the truth. A share `AGAIN` of all values is removed again; both methods
repair what remains, X̂' (divided by 1 - AGAIN), and a is the weight with which they predict best
the positions H among the values removed again:

    a = argmin over [0, 1] of Σ_H (X̂ - a Φ†(Φ(X̂')) - (1 - a) L(X̂'))²

A share p̂ of the values in H is zero, removed in the first place, but that does not matter:
E[X̂] = X, and neither method has seen X̂ in H, so for every a the expected sum is larger than that
with X instead of X̂ by the same number. Not in the paper.
"""

from collections.abc import Callable

import numpy as np

from numpy_cae.models.linear_denoiser import LinearDenoiser
from numpy_cae.motion.features import POSITIONS

AGAIN = 0.2
KEPT = 0.5
"""KEPT: the linear map is fitted to windows of which values are kept with this probability."""
Project = Callable[[np.ndarray], np.ndarray]
"""Φ†(Φ(X)) of normalised windows (N, F, 63)."""


def mixture(x: np.ndarray, p: np.ndarray, project: Project, linear: LinearDenoiser) -> np.ndarray:
    """P(X_c) of the module's equation.

    Parameters
    ----------
    x, p : (N, F, 63), (N, 1, 1) arrays of float
        Normalised windows X_c, in which zero is the mean pose, and p̂ of each.
    project : Project
    linear : LinearDenoiser
        Fitted for `KEPT`.

    Returns
    -------
    (N, F, 63) array
        A window of p̂ = 0 is the network's projection alone.
    """
    given = x / (1 - p)
    # Another generator than NumPy's default: one seed must not remove the same values twice.
    seen = np.random.Generator(np.random.Philox(0)).random(x.shape) >= AGAIN
    again = given * seen / (1 - AGAIN)
    predicted = linear.repair(KEPT * again)
    gap = np.where(seen, 0, project(again) - predicted)
    gap[..., POSITIONS.stop :] = 0
    norm = np.sum(gap**2, axis=(1, 2), keepdims=True)
    a = np.sum((given - predicted) * gap, axis=(1, 2), keepdims=True) / np.where(norm > 0, norm, 1)
    a = np.where(p > 0, np.clip(a, 0, 1), 1).astype(x.dtype)
    return a * project(given) + (1 - a) * linear.repair(KEPT * given)
