"""Completing a motion of which some values are missing.

holden2015, section 7, "Filling in Missing Data", projects a motion whose missing values are zero.
Which values are missing is known, or visible: a measured value is hardly ever zero to the last
digit. So the motion starts as an interpolation I of the known values over time. It is projected,
P = Φ†(Φ(X)), and what the projection misses at the known values is interpolated too:

    X_0     = I(X)
    X_{n+1} = X where it is known,    P(X_n) + I(X - P(X_n)) elsewhere

until n + 1 = N - 1, or ‖X_{n+1} - X_n‖ < SETTLED ‖X_1 - X_0‖. In one more step, the last, P is
averaged over all shifts of the pooling grid, which takes as long as eight projections; averaged in
every step it makes no better result (docs/lab_book/filling.md). The known values never change, and
at their neighbours there is no jump.
"""

from collections.abc import Callable

import numpy as np

Interpolate = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Values over time, and a mask of those that are known, to values that are all known."""

PROJECTIONS = 5
"""PROJECTIONS: N is at most this."""
SETTLED = 0.1
"""SETTLED: the last projection follows one that changes the unknown values by less than this share
of what the first one changed (root mean squares)."""


def completed(
    x: np.ndarray,
    known: np.ndarray,
    start: np.ndarray,
    project: Callable[[np.ndarray, bool], np.ndarray],
    interpolate: Interpolate,
    projections: int = PROJECTIONS,
) -> np.ndarray:
    """The last X_n of the module's equation.

    Parameters
    ----------
    x : array of float
        X; what is unknown in it is ignored, but has to be finite.
    known : array of bool
        Of the shape of x.
    start : array of float
        X_0.
    project : function (values, averaged) -> values
        P, averaged over all shifts or not.
    interpolate : function (values, known) -> values
        I.
    projections : int
        N, at least 1.

    Returns
    -------
    array of the shape of x
    """

    def corrected(before: np.ndarray, averaged: bool = False) -> np.ndarray:
        projected = project(before, averaged)
        missed = interpolate(np.where(known, x - projected, 0.0), known)
        return np.where(known, x, projected + missed)

    completed = np.where(known, x, start)
    if known.all():
        return completed
    first = 0.0
    for _ in range(projections - 1):
        before = completed
        completed = corrected(before)
        change = float(np.linalg.norm(completed - before))
        first = first or change
        if change < SETTLED * first:
            break
    return corrected(completed, averaged=True)
