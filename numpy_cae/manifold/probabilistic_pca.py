"""Missing values estimated from the frames around them: probabilistic PCA of fifteen frames.

`TAPS` successive frames of normalised features in one row z, by frame, then feature, are taken as

    z = m + W c + e,    c ~ N(0, I),    e ~ N(0, σ² I)

With the mean m, the axes U and the variances Λ of the principal components of the rows of training
takes, the likelihood is largest for

    σ² = the mean variance along the axes that are left out,    W = U (Λ - σ² I)^½

where σ² is at least `LEAST_NOISE` times the mean variance of an entry of z.

Where only z_o is known, with W_o and m_o the rows of W and m that belong to it, z is estimated by

    ẑ = m + W E[c | z_o],    E[c | z_o] = (W_oᵀ W_o + σ² I)⁻¹ W_oᵀ (z_o - m_o)

which has as many unknowns as c. With M = WᵀW + σ² I the same is

    E[c | z_o] = W_oᵀ (W_o W_oᵀ + σ² I)⁻¹ (z_o - m_o)
    E[c | z_o] = M⁻¹ (W_oᵀ (z_o - m_o) + W_uᵀ (ẑ_u - m_u)),
        (I - W_u M⁻¹ W_uᵀ) (ẑ_u - m_u) = W_u M⁻¹ W_oᵀ (z_o - m_o)

of which the first has as many unknowns as there are known values, the second as there are unknown
ones. The smallest of the three systems is solved.

Rows begin every `STEP` frames, so they overlap. The estimates of a frame by all rows that have it
are averaged with the weights of Hann's window,

    w_j = sin²(π (j + ½) / TAPS),   j = 0 … TAPS - 1 the place of the frame in the row

since frames in the middle of a row have the most frames on both sides.

A take of another source differs more from m + W c than takes of the training do. So missing values
are estimated twice, with σ² and with σ² + `RIDGE` times the mean variance of an entry of z;
`weighted_completion` weighs both.

References
----------
Tipping and Bishop, "Probabilistic principal component analysis", Journal of the Royal Statistical
Society B 61, 1999, sections 3.1 to 3.3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.manifold.pca import PCA
from numpy_cae.training import Windows

TAPS = 15
"""Frames of a row, as many as a filter of holden2015 has."""
STEP = 5
"""Rows that are averaged begin so many frames apart."""
AXES = 300
"""Numbers of c. More take more time, and improve little (docs/lab_book/completion.md)."""
RIDGE = 3e-4
"""This share of the mean variance is added to that of an entry where takes of another source are
completed. With 1e-6 a Gaussian is better on takes like those it is fitted to, and four times worse
on takes of another source (docs/lab_book/other_sources.md)."""
MOST_ROWS = 10_000
"""Rows that are fitted, evenly spaced over the training takes, to bound memory."""
LEAST_NOISE = 1e-6
"""The least σ², as a share of the mean variance of an entry of z."""
LEAST_VARIANCE = 1e-12
"""The least σ²."""


@dataclass(frozen=True, eq=False)
class ProbabilisticPCA:
    """The principal components of `TAPS` successive frames.

    Parameters
    ----------
    mean : (TAPS · C,) array of float
        m.
    axes : (R, TAPS · C) array of float
        Wᵀ.
    noise : float
        σ².
    """

    mean: np.ndarray
    axes: np.ndarray
    noise: float

    @classmethod
    def fit(cls, windows: Windows, is_real: np.ndarray) -> ProbabilisticPCA | None:
        """From the rows of normalised windows whose frames all count; None where there are none, or
        where all are the same.

        `is_real` (F,) tells which of the frames that the windows are cut from count.
        """
        within = windows.shape[1] - TAPS + 1  # places of a row in a window
        if within < 1:
            return None
        is_whole = np.asarray(sliding_window_view(is_real, TAPS).all(axis=1))
        rows_at = np.add.outer(windows.starts, np.arange(within)).ravel()
        rows_at = rows_at[is_whole[rows_at]]
        if not len(rows_at):
            return None
        count = min(len(rows_at), MOST_ROWS)
        chosen = rows_at[np.linspace(0, len(rows_at) - 1, count).astype(int)]
        rows = windows.frames[chosen[:, None] + np.arange(TAPS)].reshape(count, -1)
        pca = PCA.fit(rows)
        if not pca.variances.any():
            return None
        size = len(pca.mean)
        left_out = max(size - AXES, 1)
        noise = pca.variances[AXES:].sum() / left_out
        noise = max(noise, LEAST_NOISE * pca.variances.sum() / size, LEAST_VARIANCE)
        excess = np.maximum(pca.variances[:AXES] - noise, 0)
        return cls(pca.mean, np.sqrt(excess)[:, None] * pca.axes[:AXES], float(noise))

    def estimate(self, x: np.ndarray, known: np.ndarray) -> np.ndarray:
        """Estimate the values of a motion, with both variances of the module's text.

        Parameters
        ----------
        x : (T, C) array of float
            Normalised.
        known : (T, C) array of bool

        Returns
        -------
        (2, T, C) array of float64
            Known values are estimated too, but for rows without unknown ones.
        """
        return np.stack([estimate_by_rows(x, known, rows.estimate) for rows in self._rows])

    @cached_property
    def _rows(self) -> tuple[_Rows, _Rows]:
        """For takes like those of the training, and for takes of another source."""
        w = self.axes.T.astype(np.float64)
        mean_variance = np.sum(w * w) / len(w) + self.noise
        of_another = _Rows(self.mean, w, self.noise + RIDGE * mean_variance)
        return _Rows(self.mean, w, self.noise), of_another


class _Rows:
    """Estimates rows z by the module's equations, with one variance σ²."""

    def __init__(self, mean: np.ndarray, w: np.ndarray, noise: float):
        self.mean = mean
        self.w = w
        self.noise = noise
        self.projection = w @ np.linalg.inv(w.T @ w + noise * np.eye(w.shape[1]))  # W M⁻¹

    def estimate(self, z: np.ndarray, is_known: np.ndarray) -> np.ndarray:
        """ẑ of one row, (TAPS · C,)."""
        if is_known.all():
            return z
        gap = np.where(is_known, z - self.mean, 0.0)
        right = gap @ self.w  # W_oᵀ (z_o - m_o)
        known = int(np.count_nonzero(is_known))
        smallest = min(known, len(z) - known, len(right))
        noise = self.noise * np.eye(smallest)
        if smallest == known:
            w_o = self.w[is_known]
            c = w_o.T @ np.linalg.solve(w_o @ w_o.T + noise, gap[is_known])
        elif smallest == len(right):
            w_o = self.w[is_known]
            c = np.linalg.solve(w_o.T @ w_o + noise, right)
        else:
            w_u = self.w[~is_known]
            p_u = self.projection[~is_known]  # W_u M⁻¹
            missing = np.linalg.solve(np.eye(smallest) - p_u @ w_u.T, p_u @ right)
            return self.mean + self.projection @ (right + w_u.T @ missing)
        return self.mean + self.w @ c


def estimate_by_rows(
    x: np.ndarray,
    known: np.ndarray,
    estimate_row: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> np.ndarray:
    """The mean, with Hann's weights, of the estimates of overlapping rows.

    Parameters
    ----------
    x : (T, C) array of float
        Rows begin at frames 0, `STEP`, 2 `STEP`, … and T - `TAPS`. Frames beyond a motion of fewer
        than `TAPS` frames are unknown.
    known : (T, C) array of bool
    estimate_row : function (z, is_known) -> estimate
        Of a row (TAPS · C,) and its mask, the estimate (TAPS · C,).

    Returns
    -------
    (T, C) array of float64
    """
    short = max(TAPS - len(x), 0)
    values = np.pad(np.asarray(x, np.float64), ((0, short), (0, 0)))
    mask = np.pad(known, ((0, short), (0, 0)))
    last = len(values) - TAPS
    hann = np.sin(np.pi * (np.arange(TAPS) + 0.5) / TAPS)[:, None] ** 2
    sums = np.zeros_like(values)
    weights = np.zeros((len(values), 1))
    for start in [*range(0, last, STEP), last]:
        row = slice(start, start + TAPS)
        estimate = estimate_row(values[row].ravel(), mask[row].ravel())
        sums[row] += hann * estimate.reshape(TAPS, -1)
        weights[row] += hann
    return (sums / weights)[: len(x)]
