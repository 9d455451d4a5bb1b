"""Curves of cubic pieces through keys: those of PCHIP and of the cubic spline.

`scipy.interpolate` has both, and a process takes longer to import it than to repair a short file;
tests compare the two. Keys are (K,) times in ascending order, at least two, with values (K, N, C).
"""

import numpy as np


def hermite(
    keys: np.ndarray, values: np.ndarray, slopes: np.ndarray, times: np.ndarray
) -> np.ndarray:
    """The values (n, N, C) at times (n,) of the curve with these slopes (K, N, C) at the keys.

    Between two keys h apart, with the chord d, the slopes m_0 and m_1 and s the time since the
    first key,

        y(s) = v_0 + m_0 s + (3 d - 2 m_0 - m_1) s² / h + (m_0 + m_1 - 2 d) s³ / h²
    """
    piece = np.clip(np.searchsorted(keys, times, "right") - 1, 0, len(keys) - 2)
    h = np.diff(keys)[piece, None, None]
    s = (times - keys[piece])[:, None, None]
    chord = (values[piece + 1] - values[piece]) / h
    start = slopes[piece]
    cubic = (start + slopes[piece + 1] - 2 * chord) / h
    square = (chord - start) / h - cubic
    return values[piece] + (start + (square + cubic * s / h) * s) * s


def pchip_slopes(keys: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The slopes of Fritsch and Butland (1984), with which no curve overshoots: 0 at a key where
    the chords change their sign, else a weighted harmonic mean of the two chords."""
    h = np.diff(keys)[:, None, None]
    chord = np.diff(values, axis=0) / h
    if len(chord) == 1:
        return np.repeat(chord, 2, axis=0)
    product = np.maximum(chord[:-1] * chord[1:], 0)
    divisor = (h[:-1] + 2 * h[1:]) * chord[1:] + (2 * h[:-1] + h[1:]) * chord[:-1]
    slopes = np.zeros_like(values)
    weight = 3 * (h[:-1] + h[1:])
    np.divide(weight * product, divisor, out=slopes[1:-1], where=product > 0)
    slopes[0] = _end_slope(h[0], h[1], chord[0], chord[1])
    slopes[-1] = _end_slope(h[-1], h[-2], chord[-1], chord[-2])
    return slopes


def _end_slope(h0: np.ndarray, h1: np.ndarray, d0: np.ndarray, d1: np.ndarray) -> np.ndarray:
    """The slope at the first key: that of the parabola, between 0 and three times the chord d0."""
    parabola = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    return np.clip(parabola, np.minimum(3 * d0, 0), np.maximum(3 * d0, 0))


def spline(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The cubic spline: its second derivative is continuous everywhere, and the third but at the
    keys from the third to the last but two ("not a knot").

    With t from -1 to 1 it is Σ_j a_j t^j + Σ_k b_k max(t - t_k, 0)³ over j < 4 and these keys,
    and as many coefficients as keys.
    """
    middle = (keys[0] + keys[-1]) / 2
    half = (keys[-1] - keys[0]) / 2
    knots = (keys[2:-2] - middle) / half

    def terms(times: np.ndarray) -> np.ndarray:
        t = ((times - middle) / half)[:, None]
        powers = t ** np.arange(min(len(keys), 4))
        return np.hstack([powers, np.maximum(t - knots, 0) ** 3])

    coefficients = np.linalg.solve(terms(keys), values.reshape(len(keys), -1))
    return (terms(times) @ coefficients).reshape(len(times), *values.shape[1:])
