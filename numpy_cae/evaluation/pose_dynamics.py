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
(1960), forwards, and the smoother of Bryson and Frazier (1963), backwards:

    s⁻_t = A s_{t-1},   P⁻_t = A P_{t-1} Aᵀ + Q
    S_t = H P⁻_t Hᵀ + E,   K_t = P⁻_t Hᵀ S_t⁻¹,   y_t = x_t - m - H s⁻_t
    s_t = s⁻_t + K_t y_t,   P_t = P⁻_t - K_t H P⁻_t

    λ_T = 0,   λ_{t-1} = Aᵀ (λ_t - Hᵀ (S_t⁻¹ y_t + K_tᵀ λ_t)),   ŝ_t = s_t - P_t λ_t

where H has the rows of U of the known values. Unknown values are those of m + U ĉ_t. The smoother
of Rauch, Tung and Striebel (1965) has the same ŝ_t, and inverts every P⁻_t.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from numpy_cae.fast.thread_team import one_blas_thread
from numpy_cae.manifold.pca import PCA

COMPONENTS = 60
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
    lag_weights : (LAGS, R) array of float64
        a, of which A consists.
    excitation : (R,) array of float64
        The variances of n; Q has them in c_t.
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
        self.lag_weights = np.empty((LAGS, count))
        self.excitation = np.empty(count)
        for i in range(count):
            weights, *_ = np.linalg.lstsq(history[:, :, i], target[:, i], rcond=None)
            self.lag_weights[:, i] = weights
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
        state = np.zeros(count * LAGS)
        covariance = self.start
        updates = []
        poses = np.empty((len(x), count))
        spreads = []  # the rows of P_t of c_t
        for t in range(len(x)):
            if t:
                state, covariance = self._predict(state, covariance)
            state, covariance, update = self._update(state, covariance, x[t], known[t])
            poses[t] = state[:count]
            spreads.append(covariance[:count].copy())
            updates.append(update)
        adjoint = np.zeros(count * LAGS)  # λ_t
        for t in range(len(x) - 1, -1, -1):
            poses[t] -= spreads[t] @ adjoint
            h, gain, certain_gap = updates[t]
            adjoint[:count] -= h.T @ (certain_gap + gain.T @ adjoint)
            adjoint = self._step_back(adjoint)
        return self.mean + poses @ self.axes

    def _predict(self, state: np.ndarray, covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """s⁻ and P⁻ of the next frame. A writes a weighted sum of the past in the place of the last
        frame, and moves the other frames on by one."""
        count = len(self.axes)
        of_lags = (LAGS, count)
        newest = np.sum(self.lag_weights * state.reshape(of_lags), axis=0)
        with_past = np.einsum("li,lin->in", self.lag_weights, covariance.reshape(*of_lags, -1))
        with_itself = np.einsum("ilj,lj->ij", with_past.reshape(count, *of_lags), self.lag_weights)
        predicted = np.empty_like(covariance)
        predicted[:count, :count] = with_itself + np.diag(self.excitation)
        predicted[:count, count:] = with_past[:, :-count]
        predicted[count:, :count] = with_past[:, :-count].T
        predicted[count:, count:] = covariance[:-count, :-count]
        return np.concatenate([newest, state[:-count]]), predicted

    def _step_back(self, adjoint: np.ndarray) -> np.ndarray:
        """Aᵀ λ."""
        count = len(self.axes)
        before = (self.lag_weights * adjoint[:count]).ravel()
        before[:-count] += adjoint[count:]
        return before

    def _update(
        self, state: np.ndarray, covariance: np.ndarray, x: np.ndarray, known: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """s_t and P_t, given the known values of a frame; and H, of which only the columns of c_t
        are not zero, K_t and S_t⁻¹ y_t."""
        count = len(self.axes)
        h = self.axes.T[known]
        spread = covariance[:, :count] @ h.T
        innovation = h @ spread[:count] + np.diag(self.noise[known])
        gap = x[known] - self.mean[known] - h @ state[:count]
        certain = np.linalg.solve(innovation, np.column_stack([spread.T, gap]))
        gain, certain_gap = certain[:, :-1].T, certain[:, -1]
        updated = covariance - gain @ spread.T
        updated = (updated + updated.T) / 2  # without the rounding
        return state + gain @ gap, updated, (h, gain, certain_gap)
