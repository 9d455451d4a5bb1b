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
    half = angles * (np.pi / 360 if degrees else 0.5)
    sines, cosines = np.sin(half), np.cos(half)
    turned = None
    order = range(len(axes)) if axes.isupper() else reversed(range(len(axes)))
    for place in order:
        one = np.zeros((*angles.shape[:-1], 4))
        one[..., "xyz".index(axes[place].lower())] = sines[..., place]
        one[..., 3] = cosines[..., place]
        turned = one if turned is None else product(turned, one)
    return turned


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
