"""Principal component analysis, the linear counterpart of the manifold.

With u_1 … u_r the directions of largest variance about the mean m, the projection of x is

    x̂ = m + Σ_i u_i u_iᵀ (x - m)

Where entries of x are missing, the coefficients c are those most likely after the ones observed, o,
when each c_i has the variance λ_i of its axis and the residual has the variance σ² (probabilistic
PCA: Tipping & Bishop 1999):

    ĉ = argmin ‖x_o - m_o - Σ_i c_i u_io‖² / σ² + Σ_i c_i² / λ_i,    x̂ = m + Σ_i ĉ_i u_i
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

BLOCK = 4_000_000
"""Numbers that are handled at once."""
SIZES = (1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 63, 100, 150, 200, 300, 450, 700, 1000)
"""Numbers of axes that experiments choose from."""
NO_VARIANCE = 1e-11
"""Share of the largest variance below which an axis is rounding error."""


@dataclass(frozen=True)
class PCA:
    """A fitted linear manifold.

    Parameters
    ----------
    mean : (N,) array of float
    axes : (R, N) array of float
        Unit rows, by decreasing variance.
    variances : (R,) array of float
        λ_i.
    """

    mean: np.ndarray
    axes: np.ndarray
    variances: np.ndarray

    @classmethod
    def fit(cls, rows: np.ndarray) -> PCA:
        """From observations (M, N) of any dtype.

        The axes are eigenvectors of the smaller of XᵀX, (N, N), and XXᵀ, (M, M), for the rows X
        about their mean. A singular value decomposition of X gives the same in several times the
        memory. Of fewer rows than numbers, axes of no variance are left out.
        """
        mean = rows.mean(axis=0, dtype=np.float64)
        if len(rows) >= rows.shape[1]:
            blocks = (rows[block] - mean for block in _blocks(rows))
            spread, vectors = np.linalg.eigh(sum(block.T @ block for block in blocks))
            return cls(mean, vectors.T[::-1], np.maximum(spread[::-1], 0) / len(rows))
        about_mean = rows - mean
        spread, vectors = np.linalg.eigh(about_mean @ about_mean.T)
        kept = np.flatnonzero(spread > NO_VARIANCE * spread[-1])[::-1]
        axes = vectors.T[kept] @ about_mean
        axes /= np.sqrt(spread[kept, None])
        return cls(mean, axes, spread[kept] / len(rows))

    @property
    def sizes(self) -> list[int]:
        """Those of `SIZES` that are fewer than all axes, and the number of all."""
        return [size for size in SIZES if size < len(self.axes)] + [len(self.axes)]

    def project(self, x: np.ndarray, size: int) -> np.ndarray:
        """The nearest points on the manifold of the first `size` axes, in the shape of x, which is
        any whose numbers are rows of N one after the other."""
        rows, axes = x.reshape(-1, len(self.mean)), self.axes[:size]
        projected = np.empty(rows.shape)
        for block in _blocks(rows):
            np.matmul((rows[block] - self.mean) @ axes.T, axes, out=projected[block])
        return np.add(projected, self.mean, out=projected).reshape(x.shape)

    def fill(self, rows: np.ndarray, known: np.ndarray, size: int) -> np.ndarray:
        """Each row with its missing entries from the manifold of the first `size` axes.

        Parameters
        ----------
        rows : (M, N) array of float
            Unknown values are ignored.
        known : (M, N) array of bool
        size : int
            σ² is the mean variance of an entry that these axes do not explain.

        Returns
        -------
        (M, N) array of float
            The known entries as they were.
        """
        axes, variances = self.axes[:size], self.variances[:size]
        rest = max(self.variances[size:].sum() / rows.shape[1], 1e-9 * self.variances[0])
        filled = np.array(rows, dtype=np.float64)
        for row, sure in zip(filled, known, strict=True):
            seen = axes[:, sure]
            system = seen @ seen.T + np.diag(rest / np.maximum(variances, 1e-12))
            coefficients = np.linalg.solve(system, seen @ (row[sure] - self.mean[sure]))
            row[~sure] = self.mean[~sure] + coefficients @ axes[:, ~sure]
        return filled


def _blocks(rows: np.ndarray) -> Iterator[slice]:
    """Slices of the rows of about `BLOCK` numbers each."""
    count = max(1, BLOCK // rows.shape[1])
    return (slice(first, first + count) for first in range(0, len(rows), count))
