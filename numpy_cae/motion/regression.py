"""Predict the hidden numbers of a motion from the visible ones: the motion itself is the teacher.

Gløersen and Federolf (2016) fill in markers that are hidden for a while by a regression on the
principal components of the visible markers. It is fitted to the complete frames of the same take,
so that nothing has to be learned before. Here, with x_t the visible numbers in the frames t - n,
t and t + n, y_t the hidden numbers, both less their means over the complete frames, and X and Y the
matrices whose rows are these frames (at a higher rate so many of them, evenly spaced, that they are
1/30 s apart),

    ŷ_t = mean over n of x_t B + e_t,    B = (XᵀX + λ tr(XᵀX) I)⁻¹ Xᵀ Y

for n = 2, 4 and 8 frames at thirty a second, as the errors of the three regressions differ. The
ridge λ weighs the principal component with the variance s² by s² / (s² + λ Σ s²): components
with less than about λ of the variance, such as noise, count little. e_t joins the prediction to
the motion at both ends of the hole. It is the mean of a Gaussian process in time, given the
residuals r of this mean in the frames next to the hole, with the covariance (Matérn 3/2)

    k(d) = (1 + √3 |d| / ℓ) exp(-√3 |d| / ℓ),    e_t = k(t, T) k(T, T)⁻¹ r_T

over the time d between two frames, T being the times of these frames. e_t is r at the ends and
falls to zero within about ℓ, with a continuous speed.

References
----------
Gløersen and Federolf, "Predicting missing marker trajectories in human motion data using marker
intercorrelations", PLOS ONE 11, 2016. Rasmussen and Williams, "Gaussian processes for machine
learning", 2006, equations 2.23 and 4.17.
"""

import numpy as np

from numpy_cae.motion.motion import RATE

LAGS_SECONDS = (2 / RATE, 4 / RATE, 8 / RATE)
"""n of the module's equation (s), the shortest first (docs/lab_book/filling.md)."""
RIDGE = 1e-4
"""λ of the module's equation, chosen on CMU's takes among 1e-6 to 1e-2
(docs/lab_book/filling.md)."""
JOIN_SECONDS = 0.2
"""ℓ of the module's equation (s), chosen on CMU's takes among 0.2 to 1.6 s."""
JOINED_FRAMES = 12
"""At most this many known frames on each side of a hole, 1/30 s apart, are joined."""
LEAST_FRAMES = 15
"""With fewer complete frames, 1/30 s apart, nothing is predicted."""
NUGGET = 1e-4
"""The share of the variance that k(T, T) has more on its diagonal: else it is nearly singular."""


def predict_hidden(
    visible: np.ndarray,
    hidden: np.ndarray,
    is_visible: np.ndarray,
    is_known: np.ndarray,
    hole: slice,
    rate: float,
) -> np.ndarray | None:
    """The hidden numbers in a hole, by the module's equation.

    Parameters
    ----------
    visible : (F, D) array of float
        The numbers that are visible in the hole.
    hidden : (F, C) array of float
        The numbers that are hidden in the hole. Values where they are unknown are ignored.
    is_visible, is_known : (F,) arrays of bool
        In which frames the visible and the hidden numbers are known.
    hole : slice
        The frames to predict; none of them is in `is_known`.
    rate : float
        Frames a second.

    Returns
    -------
    (n, C) array of float64, or None
        None with fewer than `LEAST_FRAMES` complete frames for each n; an n with fewer is left out.

    Examples
    --------
    A second is hidden of a number that is the sum of two visible ones and as large as 2:

    >>> t = np.arange(90) / 30
    >>> visible = np.stack([np.sin(5 * t), np.cos(3 * t)], axis=1)
    >>> hidden = visible.sum(axis=1, keepdims=True)
    >>> is_visible = np.ones(90, bool)
    >>> is_known = (t < 1) | (t >= 2)
    >>> predicted = predict_hidden(visible, hidden, is_visible, is_known, slice(30, 60), 30.0)
    >>> print(np.abs(predicted - hidden[30:60]).max().round(2))
    0.02
    """
    step = max(1, round(rate / RATE))
    predictions = []
    for seconds in LAGS_SECONDS:
        lag = max(1, round(seconds * rate))
        is_complete = is_known & join_lags(is_visible[:, None], lag).all(axis=1)
        complete = np.flatnonzero(is_complete)[::step]
        if len(complete) >= LEAST_FRAMES:
            predictions.append(regress(join_lags(visible, lag), hidden, complete))
    if not predictions:
        return None
    predicted = np.mean(predictions, axis=0)
    near = joined_frames(is_known, hole, step)
    residual = (hidden - predicted)[near]
    return predicted[hole] + join_ends(
        near / rate, residual, np.arange(hole.start, hole.stop) / rate
    )


def regress(x: np.ndarray, y: np.ndarray, complete: np.ndarray) -> np.ndarray:
    """The prediction (F, C) of y (F, C) from x (F, D), fitted to the frames `complete` (N,)."""
    x = x - x[complete].mean(axis=0)
    mean = y[complete].mean(axis=0)
    return mean + x @ fit_ridge(x[complete], y[complete] - mean)


def join_lags(values: np.ndarray, lag: int) -> np.ndarray:
    """The values (F, D) of the frames t - lag, t and t + lag, (F, 3 D); beyond the ends of the
    motion those of its first and last frame."""
    frames = np.arange(len(values))
    parts = [values[np.clip(frames + shift, 0, len(values) - 1)] for shift in (-lag, 0, lag)]
    return np.concatenate(parts, axis=1)


def fit_ridge(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """B (D, C) of the module's equation, from x (N, D) and y (N, C), both without their means."""
    moments = x.T @ x
    ridge = RIDGE * np.trace(moments) or 1.0  # where nothing moves, B is 0
    return np.linalg.solve(moments + ridge * np.eye(len(moments)), x.T @ y)


def joined_frames(is_known: np.ndarray, hole: slice, step: int) -> np.ndarray:
    """The known frames on both sides of a hole that are joined, from each end every `step`-th."""
    known = np.flatnonzero(is_known)
    reach = step * JOINED_FRAMES
    before = known[(known < hole.start) & (known >= hole.start - reach)][::-1][::step][::-1]
    after = known[(known >= hole.stop) & (known < hole.stop + reach)][::step]
    return np.concatenate([before, after])


def join_ends(known_times: np.ndarray, residual: np.ndarray, times: np.ndarray) -> np.ndarray:
    """e (n, C) of the module's equation at times (n,), from residuals (K, C) at times (K,)."""
    covariance = matern(known_times[:, None] - known_times) + NUGGET * np.eye(len(known_times))
    return matern(times[:, None] - known_times) @ np.linalg.solve(covariance, residual)


def matern(distance: np.ndarray) -> np.ndarray:
    """k of the module's equation, of times between frames in seconds."""
    scaled = np.sqrt(3) * np.abs(distance) / JOIN_SECONDS
    return (1 + scaled) * np.exp(-scaled)
