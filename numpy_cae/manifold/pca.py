"""Principal component analysis, the linear counterpart of the manifold.

With u_1 … u_r the directions of largest variance about the mean m, the projection of x is

    x̂ = m + Σ_i u_i u_iᵀ (x - m)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    variances : (R,) array of float
        Of the observations along each axis.
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
        x = rows - mean
        if len(rows) >= rows.shape[1]:
            spread, vectors = np.linalg.eigh(x.T @ x)
            return cls(mean, vectors.T[::-1], np.maximum(spread[::-1], 0) / len(rows))
        spread, vectors = np.linalg.eigh(x @ x.T)
        varying = np.flatnonzero(spread > NO_VARIANCE * spread[-1])[::-1]
        axes = vectors.T[varying] @ x / np.sqrt(spread[varying, None])
        return cls(mean, axes, spread[varying] / len(rows))

    def project(self, x: np.ndarray, size: int | None) -> np.ndarray:
        """The nearest points on the manifold of the first `size` axes, or of all where None, in the
        shape of x, which is any whose numbers are rows of N one after the other."""
        axes = self.axes[:size]
        rows = x.reshape(-1, len(self.mean)) - self.mean
        return (rows @ axes.T @ axes + self.mean).reshape(x.shape)
