"""Rotations of a whole file at once, as quaternions (x, y, z, w).

`scipy.spatial.transform.Rotation.from_euler` is the definition: `tests/motion/test_quaternions.py`
holds these equal to it. It is a loop over rotations; a file of ten seconds holds forty thousand of
them, and this is a loop over axes.
"""

from __future__ import annotations

import numpy as np

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def from_euler(axes: str, angles: np.ndarray, degrees: bool = True) -> np.ndarray:
    """R = R_1 · R_2 · … for capital letters, each about the joint's own, turned axes; for small
    letters, about fixed axes, R = … · R_2 · R_1.

        q = (sin(θ/2) e, cos(θ/2))   about the axis e

    Parameters
    ----------
    axes : str
        One to three of XYZ or of xyz.
    angles : (..., len(axes)) array of float

    Returns
    -------
    (..., 4) array of float64
    """
    # An axis at a time, its numbers side by side in memory.
    half = np.ascontiguousarray(np.moveaxis(angles, -1, 0)) * (np.pi / 360 if degrees else 0.5)
    sines, cosines = np.sin(half), np.cos(half)
    first, *others = range(len(axes)) if axes.isupper() else reversed(range(len(axes)))
    nothing = np.zeros(half.shape[1:])
    turned = [nothing, nothing, nothing, cosines[first]]
    turned["xyz".index(axes[first].lower())] = sines[first]
    for place in others:
        axis = "xyz".index(axes[place].lower())
        turned = _turned_about(axis, turned, sines[place], cosines[place])
    return np.stack(turned, axis=-1)


def _turned_about(
    axis: int, turned: list[np.ndarray], sine: np.ndarray, cosine: np.ndarray
) -> list[np.ndarray]:
    """x, y, z and w of `product` with (sin e, cos), of whose three first numbers two are zero."""
    following, last = (axis + 1) % 3, (axis + 2) % 3
    result = list(turned)
    result[axis] = turned[axis] * cosine + turned[3] * sine
    result[following] = turned[following] * cosine + turned[last] * sine
    result[last] = turned[last] * cosine - turned[following] * sine
    result[3] = turned[3] * cosine - turned[axis] * sine
    return result


def product(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The quaternion of R_first · R_second, for arrays (..., 4) that broadcast."""
    ax, ay, az, aw = np.moveaxis(first, -1, 0)
    bx, by, bz, bw = np.moveaxis(second, -1, 0)
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
        axis=-1,
    )
