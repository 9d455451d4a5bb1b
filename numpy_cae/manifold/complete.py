"""Completing a motion of which some values are missing.

holden2015, section 7, "Filling in Missing Data", projects a motion whose missing values are zero.
Which values are missing is known, or visible: a measured value is hardly ever zero to the last
digit. So the motion starts as an interpolation I of the known values over time. It is projected,
P = Φ†(Φ(X)) averaged over all shifts of the pooling grid, and what the projection misses at the
known values is interpolated too:

    X_0     = I(X)
    X_{n+1} = X where it is known,    P(X_n) + I(X - P(X_n)) elsewhere

The known values never change, and at their neighbours there is no jump.
"""

from collections.abc import Callable

import numpy as np

Interpolate = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Values over time, and a mask of those that are known, to values that are all known."""

PROJECTIONS = 3
"""PROJECTIONS: N, of the module's equation. With more, holes in legs and whole poses become worse
again on sources left out of training (docs/lab_book/filling.md)."""


def completed(
    x: np.ndarray,
    known: np.ndarray,
    start: np.ndarray,
    project: Callable[[np.ndarray], np.ndarray],
    interpolate: Interpolate,
    projections: int = PROJECTIONS,
) -> np.ndarray:
    """X_N of the module's equation.

    Parameters
    ----------
    x : array of float
        X; what is unknown in it is ignored, but has to be finite.
    known : array of bool
        Of the shape of x.
    start : array of float
        X_0.
    project : function
        P, an array of the shape of x to another.
    interpolate : function (values, known) -> values
        I.
    projections : int
        N.

    Returns
    -------
    array of the shape of x
    """
    completed = np.where(known, x, start)
    for _ in range(0 if known.all() else projections):
        projected = project(completed)
        missed = interpolate(np.where(known, x - projected, 0.0), known)
        completed = np.where(known, x, projected + missed)
    return completed


def interpolated(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Values interpolated linearly over time between those that are known, each column by itself.

    Before the first and after the last known value of a column this value is repeated. A column
    without a known value is zero: in a normalised motion the mean pose.

    Parameters
    ----------
    x : (B, T, C) array of float
    known : (B, T, C) array of bool

    Returns
    -------
    (B, T, C) array of the dtype of x

    Examples
    --------
    >>> x = np.array([0.0, 9.0, 2.0, 9.0, 9.0, 5.0, 9.0]).reshape(1, 7, 1)
    >>> interpolated(x, x < 9).ravel()
    array([0., 1., 2., 3., 4., 5., 5.])
    """
    frames = x.shape[1]
    time = np.arange(frames)[:, None]
    before = np.maximum.accumulate(np.where(known, time, -1), axis=1)
    after = np.minimum.accumulate(np.where(known, time, frames)[:, ::-1], axis=1)[:, ::-1]
    first = np.where(before < 0, after, before)
    last = np.where(after == frames, before, after)
    never = (first == frames) | (last < 0)
    first = np.where(never, 0, first)
    last = np.where(never, 0, last)
    value = np.take_along_axis(x, first, axis=1)
    slope = (np.take_along_axis(x, last, axis=1) - value) / np.maximum(last - first, 1)
    return np.where(never, 0.0, value + slope * (time - first)).astype(x.dtype)
