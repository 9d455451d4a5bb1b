"""The distance between two sets of points that regularises the latent space of jang2018.

jang2018 uses the Wasserstein regulariser of its reference TBGS17 (Tolstikhin et al., "Wasserstein
Auto-Encoders"). We use the sliced Wasserstein distance instead.

In one dimension the optimal transport of one set of N points onto another pairs the smallest with
the smallest and so on; in more dimensions the sets are projected onto directions and the
one-dimensional costs are averaged.
"""

import numpy as np

from numpy_cae.ops.shapes import Pullback, require_shape

UNIT_TOLERANCE = 1e-4
"""Allowed deviation of a direction's length from 1; the rounding of float32 is far smaller."""


def sliced_wasserstein(
    z: np.ndarray, prior: np.ndarray, directions: np.ndarray
) -> tuple[float, Pullback]:
    """The squared 2-Wasserstein distance of the projections, mean over directions and points.

    In one dimension sorting solves the transport problem, so no plan between the points is needed:

        p = z · θᵀ,   q = prior · θᵀ             both (N, L), each column then sorted
        g[i] = p[order[i]] - q_sorted[i]         the gap of the i-th order statistics
        loss = Σ_directions Σ_i g² / (L N)

    Sorting is a permutation, so its derivative takes each gap back to the point it belongs to:

        dL/dp[order[i]] = 2 g[i] / (L N) · dL/dloss
        dL/dz = dL/dp · θ

    Parameters
    ----------
    z : (N, D) array of float
        The encoded points.
    prior : (N, D) array of float
        The same number of draws from the prior.
    directions : (L, D) array of float
        Rows of length 1.

    Returns
    -------
    loss : float, in the dtype of the arrays
    pullback : dloss=1.0 -> dz
        The prior and the directions get no gradient.

    Raises
    ------
    ValueError
        If a shape does not fit or a row of `directions` is not of length 1.

    References
    ----------
    jang2018, "Sequential Auto-Encoders with Wasserstein Regularizer"; the sliced form from Kolouri
    et al., "Sliced Wasserstein Auto-Encoders", ICLR 2019.

    Examples
    --------
    >>> z, prior = np.array([[3.0], [1.0]]), np.array([[0.0], [2.0]])
    >>> loss, pullback = sliced_wasserstein(z, prior, np.array([[1.0]]))
    >>> float(loss), pullback().ravel()  # 1 is paired with 0, and 3 with 2
    (1.0, array([1., 1.]))
    """
    require_shape("z", z, ("points", "dimensions"))
    require_shape("prior", prior, z.shape)
    require_shape("directions", directions, ("directions", z.shape[1]))
    lengths = np.linalg.norm(directions, axis=1)
    worst = int(np.argmax(np.abs(lengths - 1)))
    if abs(lengths[worst] - 1) > UNIT_TOLERANCE:
        raise ValueError(f"directions[{worst}] has length {lengths[worst]:.4g}, expected unit rows")
    projected = z @ directions.T
    order = np.argsort(projected, axis=0)
    gap = np.take_along_axis(projected, order, axis=0) - np.sort(prior @ directions.T, axis=0)
    loss = np.mean(gap * gap)

    def pullback(dloss: float = 1.0) -> np.ndarray:
        dprojected = np.empty_like(gap)
        np.put_along_axis(dprojected, order, (2 * float(dloss) / gap.size) * gap, axis=0)
        return dprojected @ directions

    return loss, pullback
