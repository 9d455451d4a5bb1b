"""A baseline of the manifold: a Gaussian of the frames around each frame.

The linear map of these frames follows from the moments of the Gaussian. `pose_dynamics` has a
Kalman smoother in the space of PCA, and `joint_ridge` a regression of joints on the others.

With z the values of `TAPS` successive frames in one row, by frame, then feature, m = E[z] and
S = Cov(z), both from the undamaged windows of training takes, missing values are estimated by their
mean given the rest,

    E[z_u | z_o] = m_u + S_uo S_oo⁻¹ (z_o - m_o)

where o are the known and u the unknown entries of z, and S_oo, which may be singular, stands for
S_oo + r I with r = `ridge` times the mean of all diagonal entries of S (`Gaussian.complete`). Rows
overlap, and their estimates are averaged as in `manifold.probabilistic_pca`. `fit_gaussian` chooses
the ridge on training takes that are left out. Where the mask is not given and a removed value is
zero, the best linear map of z to the frame in its middle, x, is

    A = argmin E ‖x - (k ∘ z) A‖² = M⁻¹ B,
    M_ij = E[z_i z_j] (1 - p)²   (i ≠ j),   M_ii = E[z_i²] (1 - p),   B_ij = (1 - p) E[z_i x_j]

for masks k that keep each value by itself with probability 1 - p, where M stands for M + r I, with
r of the diagonal of M (`Gaussian.linear_map`).
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.fast.thread_team import one_blas_thread
from numpy_cae.manifold.probabilistic_pca import RIDGE, TAPS, estimate_by_rows

RIDGES = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""Shares of which `fit_gaussian` chooses one."""
LEFT_OUT = 5
"""`fit_gaussian` leaves out every so-many-th take."""
CHOSEN_ON = 6
"""A ridge is chosen on at most this many windows, evenly spaced over the takes left out."""


class Moments:
    """E[z], (TAPS · C,), and E[z zᵀ], (TAPS · C, TAPS · C), of rows z that are added."""

    def __init__(self, size: int):
        self.rows = 0
        self._sum = np.zeros(size)
        self._products = np.zeros((size, size))

    def add(self, z: np.ndarray) -> None:
        """Count rows (N, TAPS · C) too."""
        self.rows += len(z)
        self._sum += z.sum(axis=0)
        self._products += z.T @ z

    def join(self, moments: Moments) -> None:
        """Count the rows of other moments too."""
        self.rows += moments.rows
        self._sum += moments._sum
        self._products += moments._products

    @property
    def mean(self) -> np.ndarray:
        """m."""
        return self._sum / self.rows

    @property
    def second(self) -> np.ndarray:
        """S + m mᵀ."""
        return self._products / self.rows

    @property
    def covariance(self) -> np.ndarray:
        """S."""
        return self.second - np.outer(self.mean, self.mean)


class Gaussian:
    """The moments of `TAPS` successive frames of normalised motion.

    From windows (N, T, C), around each frame that is `real`, (N, T) bool. A row that reaches beyond
    a window or beyond its real frames has zeros there. The linear map meets such rows at the ends
    of every window, `complete` never: there they would count as known poses (0.14 instead of 0.09
    cm, half of the values of Bandai's takes missing).

    Attributes
    ----------
    whole : Moments
        Of the rows of real frames alone, for `complete`.
    every : Moments
        Of all rows, for `linear_map`, and for `complete` where no row is whole.
    ridge : float
        This share of the mean of the diagonal of S is added to the diagonal.
    """

    def __init__(self, windows: np.ndarray, real: np.ndarray, ridge: float = RIDGE):
        self.ridge = ridge
        size = TAPS * windows.shape[-1]
        self.whole = Moments(size)
        self.every = Moments(size)
        for window, counts in zip(windows, real, strict=True):
            z = gather_context(np.asarray(window, dtype=np.float64))
            is_whole = gather_context(counts[:, None]).all(axis=1)
            self.whole.add(z[is_whole])
            self.every.add(z[counts & ~is_whole])
        self.every.join(self.whole)

    def add(self, gaussian: Gaussian) -> None:
        """Change the moments to those of the frames of both together."""
        self.whole.join(gaussian.whole)
        self.every.join(gaussian.every)

    def complete(self, x: np.ndarray, known: np.ndarray) -> np.ndarray:
        """The unknown values of windows (N, T, C), E[z_u | z_o]; `known` is a mask (N, T, C).

        `estimate_by_rows` says where rows begin.
        """
        moments = self.whole if self.whole.rows else self.every
        mean = moments.mean
        covariance = _with_ridge(moments.covariance, self.ridge)
        estimate_row = partial(_estimate_row, mean=mean, covariance=covariance)
        completed = np.empty(x.shape)
        with one_blas_thread():  # two threads wait for each other longer than they compute
            for window, mask, into in zip(x, known, completed, strict=True):
                estimate = estimate_by_rows(window, mask, estimate_row)
                into[...] = np.where(mask, window, estimate)
        return completed

    def linear_map(self, p: float) -> np.ndarray:
        """A for values that are zero with probability p, (TAPS · C, C); see `apply_linear_map`."""
        second = self.every.second
        size = len(second) // TAPS
        middle = slice(TAPS // 2 * size, (TAPS // 2 + 1) * size)
        m = (1 - p) ** 2 * second
        np.fill_diagonal(m, (1 - p) * np.diag(second))
        return np.linalg.solve(_with_ridge(m, RIDGE), (1 - p) * second[:, middle])


def _estimate_row(
    z: np.ndarray, is_known: np.ndarray, mean: np.ndarray, covariance: np.ndarray
) -> np.ndarray:
    """m + S_·o S_oo⁻¹ (z_o - m_o) of one row z, (TAPS · C,)."""
    o = np.flatnonzero(is_known)
    weights = np.zeros(len(mean))
    weights[o] = np.linalg.solve(covariance[np.ix_(o, o)], z[o] - mean[o])
    return mean + covariance @ weights


def apply_linear_map(x: np.ndarray, a: np.ndarray) -> np.ndarray:
    """z A of every frame of windows (N, T, C); frames beyond a window are zero."""
    return np.stack([gather_context(window) @ a for window in x])


def gather_context(window: np.ndarray) -> np.ndarray:
    """z: the `TAPS` frames around each frame as one row, (T, C) to (T, TAPS · C)."""
    padded = np.pad(window, ((TAPS // 2, TAPS // 2), (0, 0)))
    around = sliding_window_view(padded, TAPS, axis=0)  # (T, C, TAPS)
    return around.swapaxes(-1, -2).reshape(len(window), -1)


def _with_ridge(matrix: np.ndarray, ridge: float) -> np.ndarray:
    diagonal = np.diag(matrix)
    return matrix + ridge * diagonal.mean() * np.eye(len(diagonal))


def fit_gaussian(
    windows: np.ndarray, real: np.ndarray, take: np.ndarray, p: float = 0.5, seed: int = 0
) -> Gaussian:
    """The Gaussian of windows (N, T, C) with the ridge that completes left-out takes best.

    Every `LEFT_OUT`-th take is left out. A share p of the values of its windows, of those of which
    all frames count, is removed, drawn from the seed, and completed by a Gaussian of the other
    takes, with each of `RIDGES`: the ridge of the least mean square error is taken. Where nothing
    can be left out, it is `RIDGE`.

    Parameters
    ----------
    windows : (N, T, C) array of float
        Normalised.
    real : (N, T) array of bool
        Frames that count.
    take : (N,) array of int
        Number of the take of each window.
    p : float
    seed : int

    Returns
    -------
    Gaussian
        Of all windows.
    """
    is_left_out = take % LEFT_OUT == LEFT_OUT - 1
    usable = np.flatnonzero(is_left_out & real.all(axis=1))
    if not len(usable):
        return Gaussian(windows, real)
    chosen = usable[np.linspace(0, len(usable) - 1, min(CHOSEN_ON, len(usable))).astype(int)]
    x = windows[chosen]
    known = np.random.default_rng(seed).random(x.shape) >= p
    gaussian = Gaussian(windows[~is_left_out], real[~is_left_out])
    errors = {}
    for gaussian.ridge in RIDGES:
        errors[gaussian.ridge] = float(np.mean((gaussian.complete(x, known) - x) ** 2))
    gaussian.ridge = min(errors, key=lambda ridge: errors[ridge])
    gaussian.add(Gaussian(windows[is_left_out], real[is_left_out]))
    return gaussian
