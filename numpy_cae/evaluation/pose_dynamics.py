"""A manifold of poses that is augmented with a model of transitions, a baseline of the manifold.

holden2015, section 8, calls its manifold "more powerful and easier to use than approaches, which
first attempt to first learn a manifold over the pose space and then augment it with a statistical
model of transitions". This is the simplest such approach. The manifold of poses is that of
principal components: with the first R axes U, a frame is x_t = m + U c_t + e_t, e_t of the
variances that the axes leave in each column. The transitions are an autoregression of each
component,

    c_{t,i} = Σ_l a_{i,l} c_{t-l,i} + n_{t,i},   l = 1 … `LAGS`

by least squares within each take, without a constant, and n has the variance of what is left. Both
are fitted to training takes. With the state s_t = (c_t, …, c_{t-LAGS+1}), whose covariance in the
first frame is E[s sᵀ] over the training takes, with `FLOOR` more on the diagonal, the known values
of a frame are linear in s_t, and E[s_t | all known values] is computed by the filter of Kalman
(1960), forwards, and the smoother of Rauch, Tung and Striebel (1965), backwards:

    s⁻_t = A s_{t-1},   P⁻_t = A P_{t-1} Aᵀ + Q
    K = P⁻_t Hᵀ (H P⁻_t Hᵀ + E)⁻¹,   s_t = s⁻_t + K (x_t - m - H s⁻_t),   P_t = P⁻_t - K H P⁻_t
    ŝ_t = s_t + P_t Aᵀ (P⁻_{t+1})⁻¹ (ŝ_{t+1} - s⁻_{t+1})

where H has the rows of U of the known values. Unknown values are those of m + U ĉ_t.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation.baselines import PCA
from numpy_cae.fast.thread_team import one_blas_thread

COMPONENTS = 30
"""R: the principal components of a pose."""
LAGS = 4
"""Frames on which an autoregression looks back."""
FLOOR = 1e-6
"""The least variance of e in a column, and of n, as a share of the mean variance of a column."""


class PoseDynamics:
    """The principal components of poses and their autoregressions.

    From takes (F, C) of normalised features; those of `LAGS` frames or fewer have no transitions.

    Attributes
    ----------
    mean : (C,) array of float64
        m.
    axes : (R, C) array of float64
        Uᵀ.
    noise : (C,) array of float64
        The variances of e.
    transition : (R · LAGS, R · LAGS) array of float64
        A.
    excitation : (R,) array of float64
        The variances of n; Q has them in the components of the last frame.
    start : (R · LAGS, R · LAGS) array of float64
        The covariance of the state, which a motion begins with; its mean is zero.
    """

    def __init__(self, takes: Sequence[np.ndarray], components: int = COMPONENTS):
        poses = np.concatenate(list(takes)).astype(np.float64)
        pca = PCA.fit(poses)
        self.mean = pca.mean
        self.axes = pca.axes[:components]
        least = FLOOR * poses.var(axis=0).mean()
        about = poses - self.mean
        self.noise = np.maximum((about - about @ self.axes.T @ self.axes).var(axis=0), least)
        histories = []
        targets = []
        for take in takes:
            c = (take - self.mean) @ self.axes.T
            if len(c) > LAGS:
                before = [c[LAGS - lag : len(c) - lag] for lag in range(1, LAGS + 1)]
                histories.append(np.stack(before, axis=1))
                targets.append(c[LAGS:])
        history = np.concatenate(histories)
        target = np.concatenate(targets)
        count = len(self.axes)
        self.transition = np.zeros((count * LAGS, count * LAGS))
        self.transition[count:, :-count] = np.eye(count * (LAGS - 1))
        self.excitation = np.empty(count)
        for i in range(count):
            weights, *_ = np.linalg.lstsq(history[:, :, i], target[:, i], rcond=None)
            self.transition[i, i::count] = weights
            gap = target[:, i] - history[:, :, i] @ weights
            self.excitation[i] = max(gap.var(), least)
        states = history.reshape(len(history), -1)
        self.start = states.T @ states / len(states) + least * np.eye(states.shape[1])

    def complete(self, x: np.ndarray, known: np.ndarray) -> np.ndarray:
        """The unknown values of windows (N, T, C); `known` is a mask (N, T, C)."""
        completed = np.empty(x.shape)
        with one_blas_thread():
            for number, (window, mask) in enumerate(zip(x, known, strict=True)):
                completed[number] = self._smooth(window, mask)
        return np.where(known, x, completed)

    def _smooth(self, x: np.ndarray, known: np.ndarray) -> np.ndarray:
        """m + U ĉ_t of every frame of one window (T, C)."""
        count = len(self.axes)
        a = self.transition
        predicted = []
        filtered = []
        state = np.zeros(len(a))
        covariance = self.start
        for t in range(len(x)):
            if t:
                state = a @ state
                covariance = a @ covariance @ a.T
                covariance[np.arange(count), np.arange(count)] += self.excitation
            predicted.append((state, covariance))
            state, covariance = self._update(state, covariance, x[t], known[t])
            filtered.append((state, covariance))
        smoothed = filtered[-1][0]
        poses = [smoothed[:count]]
        for t in range(len(x) - 2, -1, -1):
            ahead, spread = predicted[t + 1]
            state, covariance = filtered[t]
            smoothed = state + covariance @ a.T @ np.linalg.solve(spread, smoothed - ahead)
            poses.append(smoothed[:count])
        return self.mean + np.stack(poses[::-1]) @ self.axes

    def _update(
        self, state: np.ndarray, covariance: np.ndarray, x: np.ndarray, known: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The state and its covariance, given the known values of a frame."""
        if not known.any():
            return state, covariance
        count = len(self.axes)
        h = self.axes.T[known]
        gain = covariance[:, :count] @ h.T
        innovation = h @ gain[:count] + np.diag(self.noise[known])
        weights = np.linalg.solve(innovation, gain.T).T
        missed = x[known] - self.mean[known] - h @ state[:count]
        # The form of Joseph: rounding leaves the covariance symmetric and positive.
        keep = np.eye(len(state))
        keep[:, :count] -= weights @ h
        noise = (weights * self.noise[known]) @ weights.T
        return state + weights @ missed, keep @ covariance @ keep.T + noise
