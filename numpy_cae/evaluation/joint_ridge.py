"""Ridge regression of joints that are missing on the other joints, a baseline of the manifold.

With the visible features v of a frame, or of the frame and of others around it, in one row, and the
hidden features h of the frame, about their means over the training takes,

    B = argmin E ‖h - v B‖² + r ‖B‖² = (E[vᵀ v] + r I)⁻¹ E[vᵀ h],   ĥ = v B

r is λ times the mean of the diagonal of E[vᵀ v]; λ is the one of `RIDGES` with the smallest error
on every fifth training take, left out, and the middle one of fewer than five takes. Hoerl and
Kennard, "Ridge regression", 1970.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RIDGES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
"""λ is one of these."""
LEFT_OUT = 5
"""Every so-many-th take is left out to choose λ."""


@dataclass(frozen=True, eq=False)
class JointRidge:
    """A fitted regression; `fit` makes it.

    Parameters
    ----------
    hidden : (H,) array of int
        Columns of a frame that are predicted.
    lags : sequence of int
        Frames, relative to the predicted one, whose other columns are used.
    mean : (V,) array of float
        Of the rows of visible values.
    hidden_mean : (H,) array of float
    weights : (V, H) array of float
        B.
    """

    hidden: np.ndarray
    lags: Sequence[int]
    mean: np.ndarray
    hidden_mean: np.ndarray
    weights: np.ndarray

    @classmethod
    def fit(
        cls, takes: Sequence[np.ndarray], hidden: np.ndarray, lags: Sequence[int] = (0,)
    ) -> JointRidge:
        """From takes (F, C) of normalised features; `hidden` are columns that are missing."""
        rows = [gather_visible(take, hidden, lags) for take in takes]
        targets = [take[:, hidden] for take in takes]
        left_out = range(LEFT_OUT - 1, len(takes), LEFT_OUT)
        ridge = RIDGES[len(RIDGES) // 2]
        if left_out:
            learned_from = [number for number in range(len(takes)) if number not in left_out]
            learned = _moments([rows[n] for n in learned_from], [targets[n] for n in learned_from])
            v = np.concatenate([rows[n] for n in left_out])
            h = np.concatenate([targets[n] for n in left_out])
            errors = {}
            for candidate in RIDGES:
                fitted = cls._solve(hidden, lags, candidate, *learned)
                errors[candidate] = float(np.mean((fitted._apply(v) - h) ** 2))
            ridge = min(errors, key=lambda candidate: errors[candidate])
        return cls._solve(hidden, lags, ridge, *_moments(rows, targets))

    @classmethod
    def _solve(
        cls,
        hidden: np.ndarray,
        lags: Sequence[int],
        ridge: float,
        mean: np.ndarray,
        hidden_mean: np.ndarray,
        squares: np.ndarray,
        products: np.ndarray,
    ) -> JointRidge:
        damped = squares + ridge * np.diag(squares).mean() * np.eye(len(squares))
        return cls(hidden, lags, mean, hidden_mean, np.linalg.solve(damped, products))

    def predict(self, take: np.ndarray) -> np.ndarray:
        """The hidden columns of a take (F, C), (F, H); what the take has in them is not used."""
        return self._apply(gather_visible(take, self.hidden, self.lags))

    def _apply(self, rows: np.ndarray) -> np.ndarray:
        return self.hidden_mean + (rows - self.mean) @ self.weights


def gather_visible(take: np.ndarray, hidden: np.ndarray, lags: Sequence[int]) -> np.ndarray:
    """The visible columns of a take (F, C) at all lags in one row a frame, (F, lags · visible); the
    first and the last frame are repeated beyond the ends."""
    visible = np.delete(np.asarray(take, dtype=np.float64), hidden, axis=1)
    frames = np.arange(len(take))
    rows = [visible[(frames + lag).clip(0, len(take) - 1)] for lag in lags]
    return np.concatenate(rows, axis=1)


def _moments(
    rows: Sequence[np.ndarray], targets: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Both means, E[vᵀ v] and E[vᵀ h] about them."""
    v = np.concatenate(rows)
    h = np.concatenate(targets).astype(np.float64)
    mean = v.mean(axis=0)
    hidden_mean = h.mean(axis=0)
    v = v - mean
    return mean, hidden_mean, v.T @ v / len(v), v.T @ (h - hidden_mean) / len(v)
