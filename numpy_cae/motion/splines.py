"""Curves through points: on each interval the cubic with given slopes at its ends (Hermite).

The two kinds of slopes are those of `PchipInterpolator` and `Akima1DInterpolator` in SciPy, which
takes a third of a second to import. `values` are (N, C) at increasing `times` (N,), at least two.
"""

import numpy as np


def hermite(
    times: np.ndarray, values: np.ndarray, slopes: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """The curve at some times: (len(at), C). With s from 0 to 1 on an interval of length h from
    y to y + Δ,  y + s Δ + s (1 - s) [(1 - s) (h y' - Δ) + s (Δ - h y'_next)]."""
    i = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    h = (times[i + 1] - times[i])[:, None]
    s = (at - times[i])[:, None] / h
    change = values[i + 1] - values[i]
    bend = (1 - s) * (h * slopes[i] - change) + s * (change - h * slopes[i + 1])
    return values[i] + s * (change + (1 - s) * bend)


def monotone_slopes(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slopes of a curve that does not overshoot (Fritsch and Butland 1984): harmonic means of the
    chords' slopes, 0 at an extremum."""
    h = np.diff(times)[:, None]
    chord = np.diff(values, axis=0) / h
    if len(h) == 1:
        return np.repeat(chord, 2, axis=0)
    left, right = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (left + right) / (left / chord[:-1] + right / chord[1:])
    inner = np.where(chord[:-1] * chord[1:] > 0, mean, 0.0)
    h, h_next, chord, chord_next = h[[0, -1]], h[[1, -2]], chord[[0, -1]], chord[[1, -2]]
    end = ((2 * h + h_next) * chord - h * chord_next) / (h + h_next)
    steep = (chord * chord_next < 0) & (np.abs(end) > 3 * np.abs(chord))
    end = np.where(end * chord > 0, np.where(steep, 3 * chord, end), 0.0)
    return np.concatenate([end[:1], inner, end[1:]])


def akima_slopes(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slopes of Akima's curve, modified so that points at rest stay at rest: means of the chords'
    slopes, each weighted by how little those on the other side differ. At least three points."""
    chord = np.diff(values, axis=0) / np.diff(times)[:, None]
    for _ in range(2):
        ends = 2 * chord[[0, -1]] - chord[[1, -2]]
        chord = np.concatenate([ends[:1], chord, ends[1:]])
    weight = np.abs(np.diff(chord, axis=0)) + np.abs(chord[1:] + chord[:-1]) / 2
    before, after = weight[2:], weight[:-2]
    total = before + after
    known = total > 1e-9 * total.max()
    mean = (before * chord[1:-2] + after * chord[2:-1]) / np.where(known, total, 1.0)
    return np.where(known, mean, (chord[3:] + chord[:-3]) / 2)
