"""Curves through known values: a Gaussian process over time for each column of numbers.

Each column, less the mean of its known values, is a Gaussian process with the covariance σ² k
(Matérn 5/2) of two values that are d frames apart,

    k(d) = (1 + s + s² / 3) exp(-s),    s = √5 |d| / ℓ

With y the known values, K = k(T, T) + ν I over their frames T, and k(t, T) the row of covariances
of frame t with them, the curve is the mean given y, and ℓ has the largest likelihood of y, with the
σ² that is best for this ℓ:

    f_t = k(t, T) K⁻¹ y,    ℓ = argmin  n log(yᵀ K⁻¹ y) + log |K|,   n = the number of known values

K is as large as the known values are many. The same numbers follow from states in time linear in
the frames. With λ = √5 / ℓ, the state z_t = (f, f' / λ, f'' / λ²) is a Markov chain,

    z_{t+1} = A z_t + q_t,   q_t ~ N(0, Q),
    A = exp(F),   F = λ ((0, 1, 0), (0, 0, 1), (-1, -3, -3))

with z_0 ~ N(0, P). The inverse covariance Λ of all states has 3 x 3 blocks on the diagonal and
beside it. With the matrix H that picks the known values f from the states, M = Λ + HᵀH / ν, and

    z = M⁻¹ Hᵀ y / ν,   yᵀ K⁻¹ y = (yᵀy - yᵀHz) / ν,   log |K| = log |M| - log |Λ| + n log ν

With the largest ℓ and few known values, rounding of Λ leaves an error of up to 1e-8 of the curve.

References
----------
Rasmussen and Williams, "Gaussian processes for machine learning", 2006, equations 2.25, 2.30, 4.17.
Hartikainen and Särkkä, "Kalman filtering and smoothing solutions to temporal Gaussian process
regression models", 2010, for the states.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from numpy_cae.motion.masks import distances_to_known

LENGTHS = (2.5, 5.0, 10.0, 20.0, 40.0)
"""The lengths ℓ (frames) from which the likelihood chooses by default."""
NOISE = 1e-4
"""ν of the module's equation, a share of σ²."""
_STATES = 3
"""Numbers of a state: value, speed, acceleration."""


class Curves(NamedTuple):
    """The curve (T, C) of each column, and the length (C,) that was chosen for it, in frames."""

    values: np.ndarray
    lengths: np.ndarray


class _Chain(NamedTuple):
    """Λ as the rows of an upper band, (6, 3 T), and log |Λ|."""

    band: np.ndarray
    log_determinant: float


def fit_curves(x: np.ndarray, known: np.ndarray, lengths: Sequence[float] = LENGTHS) -> Curves:
    """The curve through the known values of each column, by the module's equation.

    Parameters
    ----------
    x : (T, C) array of float
        T at least 1. Values where they are unknown are ignored.
    known : (T, C) array of bool
    lengths : sequence of float
        The lengths ℓ (frames) from which the likelihood chooses, increasing.

    Returns
    -------
    Curves
        In float64. Known values are as they are given, columns without one are zero with the
        shortest length, and those with equal known values are constant.

    Examples
    --------
    Three of four values of a sine are unknown:

    >>> x = np.sin(np.arange(41.0) / 5)[:, None]
    >>> known = np.arange(41)[:, None] % 4 == 0
    >>> curves = fit_curves(x, known)
    >>> print(curves.lengths, np.abs(curves.values - x).max().round(3))
    [20.] 0.018
    """
    values = np.where(known, x, 0.0).astype(np.float64)
    chosen = np.full(values.shape[1], lengths[0])
    chains = {length: _chain_of(length, len(values)) for length in lengths}
    for column in np.flatnonzero(known.any(axis=0) & ~known.all(axis=0)):
        is_known = known[:, column]
        mean = values[is_known, column].mean()
        y = np.where(is_known, values[:, column] - mean, 0.0)
        best_curve = np.zeros(len(values))
        least = np.inf
        if np.any(y):
            for length, chain in chains.items():
                curve, cost = _solve(chain, y, is_known)
                if cost < least:
                    least = cost
                    best_curve = curve
                    chosen[column] = length
        values[:, column] = np.where(is_known, values[:, column], mean + best_curve)
    return Curves(values, chosen)


def gap_variances(known: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """The variance of unknown values (T, C), as a share of σ², given the nearest known value before
    and after each of them.

    With a and b the distances to the two values, it is

        1 - (k_a² + k_b² - 2 k_a k_b k_{a+b}) / (1 - k_{a+b}²)

    between ν and 1, and 0 for known values; beyond the first or last known value of a column it is
    1 - k_a², and 1 in a column without one.

    Examples
    --------
    >>> known = np.array([[True], [False], [False], [True], [False]])
    >>> print(gap_variances(known, np.array([10.0])).ravel().round(3))
    [0.    0.001 0.001 0.    0.016]
    """
    before, after = distances_to_known(known)
    k_a = matern(before, lengths)
    k_b = matern(after, lengths)
    k_ab = np.where(known, 0.0, matern(before + after, lengths))
    explained = (k_a**2 + k_b**2 - 2 * k_a * k_b * k_ab) / (1 - k_ab**2)
    return np.where(known, 0.0, np.clip(1 - explained, NOISE, 1.0))


def matern(distance: np.ndarray, length: np.ndarray | float) -> np.ndarray:
    """k of the module's equation, of distances in frames."""
    scaled = np.sqrt(5) * np.abs(distance) / length
    return (1 + scaled + scaled * scaled / 3) * np.exp(-scaled)


def _solve(chain: _Chain, y: np.ndarray, is_known: np.ndarray) -> tuple[np.ndarray, float]:
    """The curve f (T,), and what ℓ makes smallest; y is zero where it is unknown."""
    from scipy.linalg.lapack import dpbsv  # slow to import

    band = chain.band.copy(order="F")
    band[-1, ::_STATES] += is_known / NOISE
    right = np.zeros(band.shape[1])
    right[::_STATES] = y / NOISE
    # The banded Cholesky factor of M, and M⁻¹ Hᵀ y / ν. `scipy.linalg.solveh_banded` checks its
    # arguments for longer than this takes, and does not return the factor.
    factor, states, info = dpbsv(band, right, overwrite_ab=True, overwrite_b=True)
    if info:
        raise np.linalg.LinAlgError("M is not positive definite")
    curve = states[::_STATES]
    count = np.count_nonzero(is_known)
    quadratic = max(y @ (y - curve) / NOISE, np.finfo(float).tiny)
    log_determinant = _log_determinant(factor) - chain.log_determinant + count * np.log(NOISE)
    return curve, count * np.log(quadratic) + log_determinant


def _chain_of(length: float, frames: int) -> _Chain:
    """Λ of so many frames."""
    from scipy.linalg import cholesky_banded, expm  # slow to import

    rate = np.sqrt(5) / length
    f = rate * np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, -3.0, -3.0]])
    first = np.array([[1.0, 0.0, -1 / 3], [0.0, 1 / 3, 0.0], [-1 / 3, 0.0, 1.0]])  # P
    # Van Loan, "Computing integrals involving the matrix exponential", 1978: P - A P Aᵀ would lose
    # half of the digits of Q.
    diffusion = np.zeros((_STATES, _STATES))
    diffusion[2, 2] = 16 / 3 * rate
    both = expm(np.block([[-f, diffusion], [np.zeros_like(f), f.T]]))
    a = both[_STATES:, _STATES:].T
    q_inverse = np.linalg.inv(a @ both[:_STATES, _STATES:])
    diagonal = np.repeat((q_inverse + a.T @ q_inverse @ a)[None], frames, axis=0)
    diagonal[-1] = q_inverse
    diagonal[0] += np.linalg.inv(first) - q_inverse
    beside = -a.T @ q_inverse
    band = np.zeros((2 * _STATES, _STATES * frames))
    for row in range(_STATES):
        for column in range(_STATES):
            # The entry (i, j) of Λ is in row -1 - (j - i), column j of the band.
            if column >= row:
                band[-1 - (column - row), column::_STATES] = diagonal[:, row, column]
            offset = _STATES + column - row
            band[-1 - offset, _STATES + column :: _STATES] = beside[row, column]
    return _Chain(band, _log_determinant(cholesky_banded(band, check_finite=False)))


def _log_determinant(factor: np.ndarray) -> float:
    return float(2 * np.log(factor[-1]).sum())
