"""Principal component analysis, the linear counterpart of the manifold.

With u_1 … u_r the directions of largest variance about the mean m, the projection of x is

    x̂ = m + Σ_i u_i u_iᵀ (x - m)

Where entries of x are missing, the coefficients c are those most likely after the ones observed, o,
when each c_i has the variance λ_i of its axis and the residual has the variance σ² (probabilistic
PCA: Tipping & Bishop 1999):

    ĉ = argmin ‖x_o - m_o - Σ_i c_i u_io‖² / σ² + Σ_i c_i² / λ_i,    x̂ = m + Σ_i ĉ_i u_i
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
        Unit rows, by decreasing variance.
    variances : (R,) array of float
        λ_i.
    """

    mean: np.ndarray
    axes: np.ndarray
    variances: np.ndarray

    @classmethod
    def fit(cls, rows: np.ndarray) -> PCA:
        """From observations (M, N), by singular value decomposition."""
        mean = rows.mean(axis=0)
        _, spread, axes = np.linalg.svd(rows - mean, full_matrices=False)
        return cls(mean, axes, spread**2 / len(rows))

    def project(self, rows: np.ndarray, size: int) -> np.ndarray:
        """Each row's nearest point on the manifold of the first `size` axes, (M, N) to (M, N)."""
        axes = self.axes[:size]
        return self.mean + (rows - self.mean) @ axes.T @ axes

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
