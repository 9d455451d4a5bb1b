"""Principal component analysis, the linear counterpart of the manifold.

With u_1 … u_r the directions of largest variance about the mean m, the projection of x is

    x̂ = m + Σ_i u_i u_iᵀ (x - m)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
        kept = np.flatnonzero(spread > NO_VARIANCE * spread[-1])[::-1]
        return cls(mean, vectors.T[kept] @ x / np.sqrt(spread[kept, None]))

    @property
    def sizes(self) -> list[int]:
        """Those of `SIZES` that are fewer than all axes, and the number of all."""
        return [size for size in SIZES if size < len(self.axes)] + [len(self.axes)]

    def project(self, x: np.ndarray, size: int) -> np.ndarray:
        """The nearest points on the manifold of the first `size` axes, in the shape of x, which is
        any whose numbers are rows of N one after the other."""
        axes = self.axes[:size]
        rows = x.reshape(-1, len(self.mean)) - self.mean
        return (rows @ axes.T @ axes + self.mean).reshape(x.shape)
