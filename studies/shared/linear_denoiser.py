"""The optimal linear map of a few frames, in closed form.

A frame is estimated from the `taps` frames around it (those beyond a window are zero). With z the
values of all these frames in one row, x the frame in their middle, and a mask m that keeps feature
i with probability k_i, each value of z by itself, the weights are

    A = argmin E ‖x - (m ∘ z) A‖² = M⁻¹ B,
    M_ij = E[z_i z_j] k_i k_j   (i ≠ j),      M_ii = E[z_i²] k_i,      B_ij = k_i E[z_i x_j]

since E[m_i m_j] = k_i k_j but E[m_i²] = E[m_i] = k_i. So E[z zᵀ] is computed once, from undamaged
motions, and no noise is drawn. With k = 1 - p for every feature this denoises values zeroed with
probability p; with k = 0 for one joint and 1 for the others it fills that joint in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

TAPS = 15
RIDGE = 1e-6
"""Added to M's diagonal, as a share of its mean: some features are constant (the hips' x and z)."""


@dataclass(frozen=True)
class LinearDenoiser:
    """A linear convolution over time.

    Parameters
    ----------
    weights : (taps, C, C) array of float
        Neighbouring frame, its feature, the estimated feature.
    """

    weights: np.ndarray

    def repair(self, x: np.ndarray) -> np.ndarray:
        """y_t = Σ_k x_{t + k - taps//2} A_k, windows (N, T, C) to the same."""
        frames = x.shape[-2]
        padded = _padded(x, len(self.weights))
        return sum(padded[:, k : k + frames] @ a for k, a in enumerate(self.weights))


@dataclass(frozen=True)
class Moments:
    """E[z zᵀ] of a frame and its neighbours.

    Parameters
    ----------
    second : (taps · C, taps · C) array of float64
        By frame, then feature.
    features : int
        C.
    """

    second: np.ndarray
    features: int

    @classmethod
    def of(cls, windows: np.ndarray, real: np.ndarray, taps: int = TAPS) -> Moments:
        """From whole windows (N, T, C), around the frames that are `real`, (N, T) bool."""
        size = taps * windows.shape[-1]
        total = np.zeros((size, size))
        for window, counts in zip(windows, real, strict=True):
            z = contexts(window[None], taps)[0][counts]
            total += z.T @ z
        return cls(total / np.count_nonzero(real), windows.shape[-1])

    def solve(self, kept: float | np.ndarray, ridge: float = RIDGE) -> LinearDenoiser:
        """The optimal weights where each value is kept with a probability and zero otherwise.

        Parameters
        ----------
        kept : float or (C,) array of float
            1 - p, or one probability for each feature.
        ridge : float
        """
        taps = len(self.second) // self.features
        k = np.tile(np.broadcast_to(kept, self.features), taps)
        middle = slice(taps // 2 * self.features, (taps // 2 + 1) * self.features)
        m = self.second * np.outer(k, k)
        np.fill_diagonal(m, np.diag(self.second) * k)
        m[np.diag_indices_from(m)] += ridge * np.mean(np.diag(m))
        a = np.linalg.solve(m, k[:, None] * self.second[:, middle])
        return LinearDenoiser(a.reshape(taps, self.features, self.features))


def contexts(windows: np.ndarray, taps: int) -> np.ndarray:
    """z: the `taps` frames around each frame as one row, (N, T, C) to (N, T, taps · C)."""
    around = sliding_window_view(_padded(windows, taps), taps, axis=1)  # (N, T, C, taps)
    return around.swapaxes(-1, -2).reshape(*windows.shape[:2], -1)


def _padded(windows: np.ndarray, taps: int) -> np.ndarray:
    return np.pad(windows, ((0, 0), (taps // 2, taps // 2), (0, 0)))
