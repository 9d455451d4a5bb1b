"""The shortest way between two motions along the manifold.

holden2015's abstract promises "computing similarity between motions using geodesic distance along
the manifold" and its sections do not come back to it. A path of hidden units Y_0 … Y_N has, in what
they decode to, a length and an energy,

    length = Σ_i ‖X̂_{i+1} - X̂_i‖,    E = N Σ_i ‖X̂_{i+1} - X̂_i‖²,    X̂_i = Φ†(Y_i)

with length² ≤ E, and equal where the steps are. The path of least energy between fixed ends is the
geodesic, walked evenly; its gradient

    dE/dX̂_i = 2 N (2 X̂_i - X̂_{i-1} - X̂_{i+1})

comes down to Y_i through the decoder.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from numpy_cae.manifold.motion_manifold import MotionManifold

POINTS = 9
STEPS = 60


@dataclass(frozen=True)
class Geodesic:
    """A path between two motions.

    Parameters
    ----------
    units : (N + 1, units, 256) array of float
        Y_0 … Y_N.
    length : float
        Root mean square over frames and features, in the network's own scale, summed along the
        path.
    straight : float
        The same of the path that is straight in the hidden units.
    """

    units: np.ndarray
    length: float
    straight: float


def geodesic(
    manifold: MotionManifold,
    first: np.ndarray,
    second: np.ndarray,
    points: int = POINTS,
    steps: int = STEPS,
) -> Geodesic:
    """Between the hidden units of two motions of equal length.

    Parameters
    ----------
    manifold : MotionManifold
    first, second : (units, 256) arrays of float
        As `manifold.encode` gives them.
    points : int
        N + 1, with the ends; at least 2.
    steps : int
        Of the descent from the straight path, at most.

    Raises
    ------
    ValueError
        If the motions differ in length or there are fewer than 2 points.
    """
    if first.shape != second.shape:
        raise ValueError(f"hidden units of shapes {first.shape} and {second.shape}: not one length")
    if points < 2:
        raise ValueError(f"a path of {points} points, expected at least 2")
    network = manifold.network
    share = np.linspace(0, 1, points)[:, None, None]
    straight = ((1 - share) * first + share * second).astype(first.dtype)
    if points == 2:
        length = _length(network.decode(straight))
        return Geodesic(straight, length, length)

    def of_inner(flat: np.ndarray) -> tuple[float, np.ndarray]:
        path = straight.copy()
        path[1:-1] = flat.reshape(path[1:-1].shape)
        value, d_path = network.latent_gradient(path, energy)
        return value, d_path[1:-1].ravel().astype(np.float64)

    bound = network.layers[-1].bound
    inner = np.clip(straight[1:-1], -bound, bound).ravel().astype(np.float64)
    found = minimize(
        of_inner,
        inner,
        jac=True,
        method="L-BFGS-B",
        bounds=[(-bound, bound)] * inner.size,
        options={"maxiter": steps, "maxfun": 2 * steps},
    )
    path = straight.copy()
    path[1:-1] = found.x.reshape(path[1:-1].shape)
    return Geodesic(path, _length(network.decode(path)), _length(network.decode(straight)))


def energy(x_hat: np.ndarray) -> tuple[float, np.ndarray]:
    """E of decoded windows (N + 1, T, C), as a mean over frames and features, and dE/dX̂."""
    steps = np.diff(x_hat.astype(np.float64), axis=0)
    count = len(steps) / steps[0].size
    d = np.zeros_like(x_hat, np.float64)
    d[1:] += 2 * count * steps
    d[:-1] -= 2 * count * steps
    return float(count * np.sum(steps**2)), d


def _length(x_hat: np.ndarray) -> float:
    steps = np.diff(x_hat.astype(np.float64), axis=0)
    return float(np.sqrt(np.mean(steps**2, axis=(1, 2))).sum())
