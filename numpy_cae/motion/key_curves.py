"""Curves through keys: the values of a channel in the frames around a hole.

`pchip`, `cubic` and `slerp` are those of animation programs (`ROTATION_CURVES`); pchip and slerp
begin and end with another speed than the motion has there. `with_speeds` adds to a curve c the
difference between the speed v of the motion at an end of the hole and the slope of the curve. With
t the time from that end and T at most the duration of the hole:

    x(t) = c(t) + (v - c'(0)) t (1 - |t| / T)²,  |t| < T

So value and speed are continuous at both ends. With PCHIP and T the duration of the hole this is
the cubic through values and speeds at both ends.
"""

from collections.abc import Callable

import numpy as np

from numpy_cae.motion.motion import RATE

EASE, BRIEF = 2 / 3, 0.1
"""EASE, BRIEF: T of the module's equation (s). EASE was chosen among 0.13 to 0.8 s
(docs/lab_book/filling.md); BRIEF removes the jump of the speed, and nothing else."""
Curve = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""A curve through keys: their times (K,) in seconds, ascending, their values (K, N, C), and the
times (n,) of a hole between them, to values (n, N, C). Outside the keys the curve is constant."""


def pchip(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The monotone cubic of Fritsch and Butland (1984) through all keys: no overshoot."""
    return _through("PchipInterpolator", keys, values, times)


def cubic(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The cubic spline through all keys, with continuous acceleration."""
    return _through("CubicSpline", keys, values, times)


def _through(kind: str, keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """One of SciPy's interpolators through all keys; a single key, and the outer ones, are held."""
    from scipy import interpolate  # slow to import, and seldom needed

    if len(keys) == 1:
        return np.repeat(values, len(times), axis=0)
    return getattr(interpolate, kind)(keys, values)(np.clip(times, keys[0], keys[-1]))


def slerp(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Linear between the two keys next to the hole: for rotation vectors relative to the first of
    the two this is spherical interpolation."""
    after = int(np.clip(np.searchsorted(keys, times[0]), 1, max(len(keys) - 1, 1)))
    first, last = max(after - 1, 0), min(after, len(keys) - 1)
    share = np.clip((times - keys[first]) / max(keys[last] - keys[first], 1e-9), 0.0, 1.0)
    return values[first] + share[:, None, None] * (values[last] - values[first])


def with_speeds(curve: Curve, longest: float) -> Curve:
    """The curve with the speeds at both ends of the hole, by the module's equation, T <= longest.

    Where the frames around the hole do not give its speed (`speed_at`), the curve is unchanged.
    """

    def changed(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
        after, n = int(np.searchsorted(keys, times[0])), len(times)
        duration = keys[after] - keys[after - 1] if 0 < after < len(keys) else np.inf
        third, duration = min(duration / 3, 1.0) * np.arange(1, 4), min(longest, duration)
        # Both sides, each from the hole outwards, and times within the hole near it.
        sides = (keys[:after][::-1], values[:after][::-1], 1), (keys[after:], values[after:], -1)
        ends = [
            (k[0], x, speed, sign) for k, x, sign in sides if (speed := speed_at(k, x)) is not None
        ]
        inside = [end + sign * third for end, *_, sign in ends]
        points = curve(keys, values, np.concatenate([times, *inside]))
        result, *near = np.split(points, n + 3 * np.arange(len(ends)))
        for (end, x, speed, sign), (c1, c2, c3) in zip(ends, near, strict=True):
            # The curve is a cubic over the hole, whose slope these four values determine.
            slope = sign * (-11 * x[0] + 18 * c1 - 9 * c2 + 2 * c3) / (6 * third[0])
            t = (times - end)[:, None, None]
            result += (speed - slope) * t * np.clip(1 - np.abs(t) / duration, 0.0, None) ** 2
        return result

    return changed


def speed_at(times: np.ndarray, values: np.ndarray) -> np.ndarray | None:
    """The speed (N, C) at the first of some keys: the derivative of the parabola through it and
    the keys 1/30 s and 2/30 s away. None where these are not successive frames: speeds between
    sparse keyframes are PCHIP's."""
    if len(times) < 3:
        return None
    step = max(1, round(1 / (RATE * abs(times[1] - times[0]))))
    if len(times) <= 2 * step or abs(times[2 * step] - times[0]) > 2.5 / RATE:
        return None
    x0, x1, x2 = values[[0, step, 2 * step]]
    return (3 * x0 - 4 * x1 + x2) / (times[0] - times[2 * step])


ROTATION_CURVES: dict[str, Curve] = {"pchip": pchip, "cubic": cubic, "slerp": slerp}
eased = with_speeds(pchip, EASE)
CURVES: dict[str, Curve] = {
    "eased": eased,
    "pchip": with_speeds(pchip, BRIEF),
    "cubic": cubic,
    "slerp": with_speeds(slerp, BRIEF),
}
"""The curves of `fill` and `repair`; in none of them the speed jumps."""


def mean_curve(weights: np.ndarray) -> Curve:
    """The mean of `CURVES` with these weights, (4,), whose sum is 1."""

    def curve(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
        parts = [x(keys, values, times) for x in CURVES.values()]
        return np.tensordot(weights, parts, axes=1)

    return curve
