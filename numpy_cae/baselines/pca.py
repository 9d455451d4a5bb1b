"""Principal component analysis: the linear manifold that a sensible person would try first.

With u_1 … u_r the directions of largest variance about the mean m, the projection of x is

    x̂ = m + Σ_i u_i u_iᵀ (x - m)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class PCA:
    """A fitted linear manifold.

    Parameters
    ----------
    mean : (N,) array of float
    axes : (R, N) array of float
        Unit rows, by falling variance.
    """

    mean: np.ndarray
    axes: np.ndarray

    @classmethod
    def fit(cls, rows: np.ndarray) -> PCA:
        """From observations (M, N), by singular value decomposition."""
        mean = rows.mean(axis=0)
        _, _, axes = np.linalg.svd(rows - mean, full_matrices=False)
        return cls(mean, axes)

    def project(self, rows: np.ndarray, size: int) -> np.ndarray:
        """Each row's nearest point on the manifold of the first `size` axes, (M, N) to (M, N)."""
        axes = self.axes[:size]
        return self.mean + (rows - self.mean) @ axes.T @ axes
