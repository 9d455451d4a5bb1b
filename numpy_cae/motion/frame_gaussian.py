"""What the values of a frame say about one another: a Gaussian of the frames of one motion.

The frames x_t of a motion are taken as draws of a Gaussian with their mean μ and their covariance
S, to which λ tr(S) I is added. With the precision P = (S + λ tr(S) I)⁻¹, each value is predicted by
the others of its frame, a ridge regression on these for all columns at once:

    x̂_c = μ_c - Σ_{j≠c} P_cj (x_j - μ_j) / P_cc

Where some values m_t of a frame are uncertain, with variances V, since they were interpolated over
time, both sources of knowledge are weighed by their precisions,

    x̂_t = μ + (P + V⁻¹)⁻¹ V⁻¹ (m_t - μ)

with V ≈ 0 for known values. μ and S, first those of the m_t, then are estimated again, from the x̂_t
and the covariance that is left of each, none of a frame that is known, which is expectation
maximisation:

    μ ← mean_t x̂_t,    S ← mean_t ((x̂_t - μ)(x̂_t - μ)ᵀ + (P + V_t⁻¹)⁻¹)

and m_t is weighed against the new S. Variances of columns, of which V is a share, are the diagonal
of S + λ tr(S) I.

References
----------
Gløersen and Federolf, "Predicting missing marker trajectories in human motion data using marker
intercorrelations", PLOS ONE 11, 2016, for markers predicted by markers of the same take. Lauritzen,
"Graphical models", 1996, section 5.1.3, for P and regression. Dempster, Laird and Rubin, "Maximum
likelihood from incomplete data via the EM algorithm", 1977.
"""

import numpy as np

RIDGE = 1e-3
"""λ of the module's equations, of a prototype compared on takes of Bandai and CMU
(docs/lab_book/completion.md)."""
ESTIMATES = 2
"""S is estimated so many times in `condition_frames`. A third time changes errors by 1%."""
KNOWN_VARIANCE = 1e-6
"""V of a known value, as a share of the variance of its column."""
FRAMES_AT_ONCE = 32
"""So many frames are conditioned together, in the columns that are unknown in some of them."""


def predict_from_others(x: np.ndarray) -> np.ndarray:
    """x̂ of the first equation: each value of x (T, C) predicted by the others of its frame.

    Examples
    --------
    The third column is the sum of the first two:

    >>> x = np.random.default_rng(0).normal(size=(50, 2))
    >>> x = np.column_stack([x, x.sum(axis=1)])
    >>> print(np.abs(predict_from_others(x) - x).max().round(2))
    0.03
    """
    mean = x.mean(axis=0)
    centred = x - mean
    precision = np.linalg.inv(_with_ridge(centred.T @ centred / len(x)))
    weights = -precision / np.diag(precision)
    np.fill_diagonal(weights, 0.0)
    return mean + centred @ weights


def condition_frames(x: np.ndarray, known: np.ndarray, variances: np.ndarray) -> np.ndarray:
    """x̂ of the second equation, with S estimated `ESTIMATES` times.

    Interpolations that are wrong at the same time err in the same direction, so V is multiplied by
    the number of unknown values for each known one in the frame, where this is above 1.

    Parameters
    ----------
    x : (T, C) array of float64
        m_t: known values, and curves through them.
    known : (T, C) array of bool
    variances : (T, C) array of float
        V of unknown values as a share of the variance of their column.

    Returns
    -------
    (T, C) array of float64
        Known values as they are given.
    """
    incomplete = np.flatnonzero(~known.all(axis=1))
    blocks = [
        incomplete[start : start + FRAMES_AT_ONCE]
        for start in range(0, len(incomplete), FRAMES_AT_ONCE)
    ]
    known_counts = known.sum(axis=1, keepdims=True)
    shared = np.maximum(1.0, (known.shape[1] - known_counts) / np.maximum(known_counts, 1))
    shares = np.where(known, KNOWN_VARIANCE, shared * variances)
    conditioned = x
    left_over = np.zeros((x.shape[1], x.shape[1]))
    for number in range(1, ESTIMATES + 1):
        mean = conditioned.mean(axis=0)
        centred = conditioned - mean
        covariance = _with_ridge(centred.T @ centred / len(x) + left_over)
        precision = np.linalg.inv(covariance)
        certainties = 1 / (shares * np.diag(covariance))
        conditioned = x.copy()
        left_over = np.zeros_like(covariance)
        for frames in blocks:
            # Columns that are known in all of these frames do not change: they are on the right.
            some = np.flatnonzero(~known[frames].all(axis=0))
            of_some = np.ix_(frames, some)
            certainty = certainties[of_some]
            to_others = (x[frames] - mean) @ precision[:, some]
            to_others -= (x[of_some] - mean[some]) @ precision[np.ix_(some, some)]
            right = certainty * (x[of_some] - mean[some]) - to_others
            inverse = precision[np.ix_(some, some)] + certainty[:, :, None] * np.eye(len(some))
            if number < ESTIMATES:
                posterior = np.linalg.inv(inverse)
                left_over[np.ix_(some, some)] += posterior.sum(axis=0) / len(x)
                offset = posterior @ right[..., None]
            else:
                offset = np.linalg.solve(inverse, right[..., None])
            estimate = mean[some] + offset[..., 0]
            conditioned[of_some] = np.where(known[of_some], x[of_some], estimate)
    return conditioned


def _with_ridge(covariance: np.ndarray) -> np.ndarray:
    """S + λ tr(S) I; where nothing moves, I."""
    ridge = RIDGE * np.trace(covariance) or 1.0
    return covariance + ridge * np.eye(len(covariance))
