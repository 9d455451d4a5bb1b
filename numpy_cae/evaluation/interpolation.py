"""Interpolation between known values over time: easier than repair, where the known values are not
given.

`ROTATION_CURVES` are the curves of animation programs. Each is given the mask of the hole and the
rotations of the rig on both sides of it, and nothing else:

- "pchip", a monotone cubic, which does not overshoot
- "cubic", the cubic spline with continuous acceleration
- "slerp", a rotation at constant speed from the last known frame to the next one

`motion.retarget.curves.on_curves(motion, missing, ROTATION_CURVES["pchip"])` is a motion filled
by such a curve.
"""

import numpy as np

from numpy_cae.motion.retarget.curves import Curve

__all__ = ["ROTATION_CURVES", "interpolate_cubically", "interpolate_linearly"]


def interpolate_linearly(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Linear interpolation of each feature between its known values.

        x̂_t = x_a + (t - a) / (b - a) · (x_b - x_a),    a ≤ t ≤ b the known frames around t

    Before the first known value and after the last, that value is repeated; a feature without known
    values is left unchanged.

    Parameters
    ----------
    x : (…, T, C) array of float
        Unknown values are ignored.
    known : array of bool of the same shape

    Returns
    -------
    array of the shape and dtype of x
    """
    filled = x.copy()
    frames = np.arange(x.shape[-2])
    for index in np.ndindex(x.shape[:-2]):
        for feature in range(x.shape[-1]):
            series = (*index, slice(None), feature)
            sure = known[series]
            if sure.any():
                filled[series] = np.interp(frames, frames[sure], x[series][sure])
    return filled


def interpolate_cubically(x: np.ndarray, keys: np.ndarray) -> np.ndarray:
    """The cubic spline through key frames, with "not a knot" ends; the last key is repeated.

    Parameters
    ----------
    x : (…, T, C) array of float
    keys : (K,) array of int
        The known frames, rising, at least two.

    Returns
    -------
    array of the shape and dtype of x
    """
    from scipy.interpolate import CubicSpline  # slow to import, and not needed to grade

    spline = CubicSpline(keys, np.take(x, keys, axis=-2), axis=x.ndim - 2)
    return spline(np.clip(np.arange(x.shape[-2]), keys[0], keys[-1])).astype(x.dtype)


def pchip(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The monotone cubic of Fritsch and Butland (1984) through all keys, a `Curve`."""
    return _through("PchipInterpolator", keys, values, times)


def cubic(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The cubic spline through all keys, a `Curve`."""
    return _through("CubicSpline", keys, values, times)


def _through(kind: str, keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """One of SciPy's interpolators through all keys; a single key, and the outer ones, are held."""
    from scipy import interpolate  # slow to import, and seldom needed

    if len(keys) == 1:
        return np.repeat(values, len(times), axis=0)
    return getattr(interpolate, kind)(keys, values)(np.clip(times, keys[0], keys[-1]))


def slerp(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Linear between the two keys next to the hole, a `Curve`: for rotation vectors relative to the
    first of the two this is spherical interpolation."""
    after = int(np.clip(np.searchsorted(keys, times[0]), 1, max(len(keys) - 1, 1)))
    first, last = max(after - 1, 0), min(after, len(keys) - 1)
    share = np.clip((times - keys[first]) / max(keys[last] - keys[first], 1e-9), 0.0, 1.0)
    return values[first] + share[:, None, None] * (values[last] - values[first])


ROTATION_CURVES: dict[str, Curve] = {"pchip": pchip, "cubic": cubic, "slerp": slerp}
"""The curves through rotations that animation programs draw, by name."""
