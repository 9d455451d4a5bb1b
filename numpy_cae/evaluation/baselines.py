"""Baselines of the manifold: a Gaussian of the frames around each frame, and PCA.

The linear map of these frames follows from the moments of the Gaussian.

With z the values of `TAPS` successive frames in one row, m = E[z] and S = Cov(z), both from the
undamaged windows of training takes, missing values are estimated by their mean given the rest,

    E[z_u | z_o] = m_u + S_uo S_oo⁻¹ (z_o - m_o)

where o are the known and u the unknown entries of z, and S_oo, which may be singular, stands for
S_oo + r I with r = `RIDGE` times the mean of all diagonal entries of S (`Gaussian.complete`). Where
the mask is not given and a removed value is zero, the best linear map of z to the frame in its
middle, x, is

    A = argmin E ‖x - (k ∘ z) A‖² = M⁻¹ B,
    M_ij = E[z_i z_j] (1 - p)²   (i ≠ j),   M_ii = E[z_i²] (1 - p),   B_ij = (1 - p) E[z_i x_j]

for masks k that keep each value by itself with probability 1 - p, where M stands for M + r I, with
r of the diagonal of M (`Gaussian.linear_map`).

Principal component analysis is the linear counterpart of the manifold. With u_1 … u_r the
directions of largest variance about the mean m, the projection of x is

    x̂ = m + Σ_i u_i u_iᵀ (x - m)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.fast.thread_team import one_blas_thread

TAPS = 15
"""Frames of a row, as many as a filter of holden2015 has."""
MIDDLE = 7
"""The frames in the middle of a row that `Gaussian.complete` takes from it."""
RIDGE = 3e-4
"""This share of the mean of the diagonal of S, or of M, is added to the diagonal. With 1e-6
the Gaussian is a little better on takes like those it is fitted to, and four times worse on takes
of another source (docs/lab_book/other_sources.md)."""


class Gaussian:
    """The moments of `TAPS` successive frames of normalised motion.

    From whole windows (N, T, C), around the frames that are `real`, (N, T) bool; frames beyond a
    window are zero.

    Attributes
    ----------
    mean : (TAPS · C,) array of float64
        m, by frame, then feature.
    second : (TAPS · C, TAPS · C) array of float64
        E[z zᵀ]; S is E[z zᵀ] - m mᵀ.
    """

    def __init__(self, windows: np.ndarray, real: np.ndarray):
        size = TAPS * windows.shape[-1]
        total = np.zeros(size)
        self.second = np.zeros((size, size))
        for window, counts in zip(windows, real, strict=True):
            z = gather_context(window)[counts]
            total += z.sum(axis=0)
            self.second += z.T @ z
        frames = np.count_nonzero(real)
        self.mean = total / frames
        self.second /= frames

    def complete(self, x: np.ndarray, known: np.ndarray) -> np.ndarray:
        """The unknown values of windows (N, T, C), E[z_u | z_o]; `known` is a mask (N, T, C).

        Frames 0 to 6, 7 to 13, … (`MIDDLE`) are each estimated from the row z in whose middle
        they are. Frames beyond a window are unknown.
        """
        covariance = _with_ridge(self.second - np.outer(self.mean, self.mean))
        before = (TAPS - MIDDLE) // 2
        padding = ((before, TAPS), (0, 0))
        estimates = np.array(x, dtype=np.float64)
        with one_blas_thread():  # two threads wait for each other longer than they compute
            for window, mask, estimate in zip(x, known, estimates, strict=True):
                padded = np.pad(window, padding)
                padded_mask = np.pad(mask, padding)
                for start in range(0, len(window), MIDDLE):
                    z = padded[start : start + TAPS]
                    is_known = padded_mask[start : start + TAPS]
                    middle = slice(start, min(start + MIDDLE, len(window)))
                    if mask[middle].all():
                        continue
                    row = self._complete_row(z.ravel(), is_known.ravel(), covariance)
                    estimate[middle] = row.reshape(TAPS, -1)[before:][: middle.stop - start]
        return np.where(known, x, estimates)

    def _complete_row(
        self, z: np.ndarray, is_known: np.ndarray, covariance: np.ndarray
    ) -> np.ndarray:
        """m + S_·o S_oo⁻¹ (z_o - m_o) of one row z, (TAPS · C,)."""
        o = np.flatnonzero(is_known)
        weights = np.zeros(len(self.mean))
        weights[o] = np.linalg.solve(covariance[np.ix_(o, o)], z[o] - self.mean[o])
        return self.mean + covariance @ weights

    def linear_map(self, p: float) -> np.ndarray:
        """A for values that are zero with probability p, (TAPS · C, C); see `apply_linear_map`."""
        size = len(self.mean) // TAPS
        middle = slice(TAPS // 2 * size, (TAPS // 2 + 1) * size)
        m = (1 - p) ** 2 * self.second
        np.fill_diagonal(m, (1 - p) * np.diag(self.second))
        return np.linalg.solve(_with_ridge(m), (1 - p) * self.second[:, middle])


def apply_linear_map(x: np.ndarray, a: np.ndarray) -> np.ndarray:
    """z A of every frame of windows (N, T, C); frames beyond a window are zero."""
    return np.stack([gather_context(window) @ a for window in x])


def gather_context(window: np.ndarray) -> np.ndarray:
    """z: the `TAPS` frames around each frame as one row, (T, C) to (T, TAPS · C)."""
    padded = np.pad(window, ((TAPS // 2, TAPS // 2), (0, 0)))
    around = sliding_window_view(padded, TAPS, axis=0)  # (T, C, TAPS)
    return around.swapaxes(-1, -2).reshape(len(window), -1)


def _with_ridge(matrix: np.ndarray) -> np.ndarray:
    diagonal = np.diag(matrix)
    return matrix + RIDGE * diagonal.mean() * np.eye(len(diagonal))


NO_VARIANCE = 1e-11
"""Share of the largest variance below which an axis is rounding error."""


@dataclass(frozen=True, eq=False)
class PCA:
    """A fitted linear manifold.

    Parameters
    ----------
    mean : (N,) array of float
    axes : (R, N) array of float
        Unit rows, by decreasing variance.
    """

    mean: np.ndarray
    axes: np.ndarray

    @classmethod
    def fit(cls, rows: np.ndarray) -> PCA:
        """From observations (M, N) of any dtype.

        The axes are eigenvectors of the smaller of XᵀX, (N, N), and XXᵀ, (M, M), for the rows X
        about their mean. A singular value decomposition of X gives the same in several times the
        memory. Of fewer rows than numbers, axes of no variance are left out.
        """
        mean = rows.mean(axis=0, dtype=np.float64)
        x = rows - mean
        if len(rows) >= rows.shape[1]:
            return cls(mean, np.linalg.eigh(x.T @ x)[1].T[::-1])
        spread, vectors = np.linalg.eigh(x @ x.T)
        varying = np.flatnonzero(spread > NO_VARIANCE * spread[-1])[::-1]
        return cls(mean, vectors.T[varying] @ x / np.sqrt(spread[varying, None]))

    def project(self, x: np.ndarray, size: int | None) -> np.ndarray:
        """The nearest points on the manifold of the first `size` axes, or of all where None, in the
        shape of x, which is any whose numbers are rows of N one after the other."""
        axes = self.axes[:size]
        rows = x.reshape(-1, len(self.mean)) - self.mean
        return (rows @ axes.T @ axes + self.mean).reshape(x.shape)
