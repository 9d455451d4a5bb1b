"""Curves through keys: interpolation of a channel over a hole from the frames around it.

`pchip`, `cubic` and `slerp` are those of animation programs (`ROTATION_CURVES`). The speed of pchip
and slerp at the ends of a hole differs from that of the motion. `with_speeds` adds to a curve c the
difference between the speed v of the motion at an end of the hole and the slope of the curve. With
t the time from that end and T at most the duration of the hole:

    x(t) = c(t) + (v - c'(0)) t (1 - |t| / T)²,  |t| < T

So value and speed are continuous at both ends. With PCHIP and T the duration of the hole this is
the cubic through values and speeds at both ends.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from numpy_cae.motion.motion import RATE

EASE_SECONDS = 2 / 3
"""EASE_SECONDS: T of the module's equation (s) for the curve "eased", chosen among 0.13 to 0.8 s
(docs/lab_book/filling.md)."""
BRIEF_SECONDS = 0.1
"""BRIEF_SECONDS: T (s) for other curves: their speed does not jump, and little else changes."""
Curve = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""A curve through keys: their times (K,) in seconds, ascending, their values (K, N, C), and the
times (n,) of a hole between them, to values (n, N, C). Outside the keys the curve is constant."""


def pchip(
    keys: np.ndarray, values: np.ndarray, times: np.ndarray, derivative: int = 0
) -> np.ndarray:
    """The monotone cubic of Fritsch and Butland (1984) through all keys, or a derivative of it: no
    overshoot."""
    from scipy.interpolate import PchipInterpolator  # slow to import, and seldom needed

    if len(keys) == 1:
        return np.repeat(values, len(times), axis=0)
    return PchipInterpolator(keys, values)(np.clip(times, keys[0], keys[-1]), derivative)


def cubic(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The cubic spline through all keys, with continuous acceleration."""
    from scipy.interpolate import CubicSpline

    if len(keys) == 1:
        return np.repeat(values, len(times), axis=0)
    return CubicSpline(keys, values)(np.clip(times, keys[0], keys[-1]))


def slerp(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Linear between the two keys next to the hole: for rotation vectors relative to the first of
    the two this is spherical interpolation."""
    after = int(np.clip(np.searchsorted(keys, times[0]), 1, max(len(keys) - 1, 1)))
    first = max(after - 1, 0)
    last = min(after, len(keys) - 1)
    share = np.clip((times - keys[first]) / max(keys[last] - keys[first], 1e-9), 0.0, 1.0)
    return values[first] + share[:, None, None] * (values[last] - values[first])


def slerp_slope(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The slope of `slerp` at the two keys next to the hole, `times` (2,)."""
    first, last = np.searchsorted(keys, times)
    return (values[[last, last]] - values[[first, first]]) / (keys[last] - keys[first])


def with_speeds(curve: Curve, slope: Curve, longest: float) -> Curve:
    """The curve with the speeds at both ends of the hole, by the module's equation, T <= longest.

    `slope` gives the slope of the curve at the two keys next to the hole. Where the frames around
    the hole do not give its speed (`speed_at`), the curve is unchanged.
    """

    def changed(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
        result = curve(keys, values, times)
        after = int(np.searchsorted(keys, times[0]))
        duration = longest
        slopes = np.zeros((2, *values.shape[1:]))  # of the constant outside of the keys
        if 0 < after < len(keys):
            ends = keys[after - 1 : after + 1]
            duration = min(longest, ends[1] - ends[0])
            slopes = slope(keys, values, ends)
        outwards = (slice(after - 1, None, -1) if after else slice(0), slice(after, None))
        for side, slope_there in zip(outwards, slopes, strict=True):
            speed = speed_at(keys[side], values[side])
            if speed is not None:
                t = (times - keys[side][0])[:, None, None]
                ramp = np.clip(1 - np.abs(t) / duration, 0.0, None) ** 2
                result += (speed - slope_there) * t * ramp
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
pchip_slope = partial(pchip, derivative=1)
eased = with_speeds(pchip, pchip_slope, EASE_SECONDS)
CURVES: dict[str, Curve] = {
    "eased": eased,
    "pchip": with_speeds(pchip, pchip_slope, BRIEF_SECONDS),
    "cubic": cubic,
    "slerp": with_speeds(slerp, slerp_slope, BRIEF_SECONDS),
}
"""CURVES: the curves of `fill` and `repair`; the speed jumps in none of them."""


def mean_curve(weights: np.ndarray) -> Curve:
    """The mean of `CURVES` with these weights, (4,), whose sum is 1."""

    def curve(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
        parts = [x(keys, values, times) for x in CURVES.values()]
        return np.tensordot(weights, parts, axes=1)

    return curve
