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
BETWEEN_POINTS, BETWEEN_STEPS = 3, 10
"""Where a length alone is wanted: more of either change it by less than a thousandth."""
AT_ONCE = 16
"""Paths that are shortened together: large batches are quicker."""


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
    straight = _straight(first[None], second[None], points)
    path = _shortened(manifold, straight, steps)
    lengths = (_lengths(manifold, way)[0] for way in (path, straight))
    return Geodesic(path[0], *lengths)


def geodesic_lengths(
    manifold: MotionManifold,
    first: np.ndarray,
    second: np.ndarray,
    points: int = BETWEEN_POINTS,
    steps: int = BETWEEN_STEPS,
) -> np.ndarray:
    """The length of the geodesic of each of P pairs: how unlike two motions are, (P,) of float64.

    Parameters
    ----------
    manifold : MotionManifold
    first, second : (P, units, 256) arrays of float
    points, steps : int
        As `geodesic` takes them.
    """
    parts = [slice(start, start + AT_ONCE) for start in range(0, len(first), AT_ONCE)]
    straight = (_straight(first[part], second[part], points) for part in parts)
    found = [_lengths(manifold, _shortened(manifold, way, steps)) for way in straight]
    return np.concatenate(found) if found else np.zeros(0)


def energy(x_hat: np.ndarray) -> tuple[float, np.ndarray]:
    """E of decoded paths (…, N + 1, T, C), a mean over frames and features, summed over paths; and
    dE/dX̂."""
    steps = np.diff(x_hat.astype(np.float64), axis=-3)
    count = steps.shape[-3] / np.prod(steps.shape[-2:])
    d = np.zeros_like(x_hat, np.float64)
    d[..., 1:, :, :] += 2 * count * steps
    d[..., :-1, :, :] -= 2 * count * steps
    return float(count * np.sum(steps**2)), d


def _straight(first: np.ndarray, second: np.ndarray, points: int) -> np.ndarray:
    """(P, N + 1, units, 256): as far from each point to the next in every hidden unit."""
    if points < 2:
        raise ValueError(f"a path of {points} points, expected at least 2")
    share = np.linspace(0, 1, points)[:, None, None]
    return ((1 - share) * first[:, None] + share * second[:, None]).astype(first.dtype)


def _shortened(manifold: MotionManifold, straight: np.ndarray, steps: int) -> np.ndarray:
    """The paths of least energy between the ends of paths (P, N + 1, units, 256)."""
    network = manifold.network
    inner = straight[:, 1:-1]
    if inner.size == 0:
        return straight
    x_first, x_last = (network.decode(straight[:, end])[:, None] for end in (0, -1))

    def of_windows(x_hat: np.ndarray) -> tuple[float, np.ndarray]:
        between = x_hat.reshape(*inner.shape[:2], *x_hat.shape[1:])
        value, d = energy(np.concatenate([x_first, between, x_last], axis=1))
        return value, d[:, 1:-1].reshape(x_hat.shape).astype(x_hat.dtype)

    def of_units(flat: np.ndarray) -> tuple[float, np.ndarray]:
        y = flat.astype(straight.dtype).reshape(-1, *inner.shape[2:])
        value, dy = network.latent_gradient(y, of_windows)
        return value, dy.ravel().astype(np.float64)

    bound = network.layers[-1].bound
    path = straight.copy()
    if steps > 0:
        # No bounds: SciPy takes a tuple a number, longer than the descent. Beyond them arctanh is
        # clipped and the energy does not change.
        found = minimize(
            of_units,
            np.clip(inner, -bound, bound).ravel().astype(np.float64),
            jac=True,
            method="L-BFGS-B",
            options={"maxiter": steps, "maxfun": 2 * steps},
        )
        path[:, 1:-1] = np.clip(found.x.reshape(inner.shape), -bound, bound)
    return path


def _lengths(manifold: MotionManifold, paths: np.ndarray) -> np.ndarray:
    x_hat = manifold.network.decode(paths.reshape(-1, *paths.shape[2:])).astype(np.float64)
    steps = np.diff(x_hat.reshape(*paths.shape[:2], *x_hat.shape[1:]), axis=1)
    return np.sqrt(np.mean(steps**2, axis=(2, 3))).sum(axis=1)
