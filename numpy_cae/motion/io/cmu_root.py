"""What the CMU text says of the root, put right.

The database turns a root by R = Rz · Ry · Rx. Whoever made the text took the same three angles and
multiplied them as Rz · Rx · Ry. Of someone who faces +Z the two are nearly alike; of someone who
turns round they are not: while the heading passes 90° the person in the text lies on the floor.
The three angles can be had back from the text's rotation, and from them the true one: on trial
02_01, which is also there as an Acclaim file, the root then agrees within 2e-6 radians, without
it within 1.3e-2.

Three angles and (z + π, π - x, y + π) are the same rotation in the text's order, but in the
database's they are two; so the angles are followed from frame to frame.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

_TURN = 2 * np.pi
_CUT = 1.5
"""Radians in one frame of the text: no motion, but a cut, as after the T-pose."""


def true_root(text: Rotation) -> Rotation:
    """The root's rotations as the database has them.

    Parameters
    ----------
    text : Rotation
        Of every frame, as the text says.
    """
    zxy = text.as_euler("ZXY")
    other = np.stack([zxy[:, 0] + np.pi, np.pi - zxy[:, 1], zxy[:, 2] + np.pi], axis=1)
    cuts = np.append(True, (text[1:] * text[:-1].inv()).magnitude() > _CUT)
    followed = np.empty_like(zxy)
    for frame, (one, two, cut) in enumerate(zip(zxy, other, cuts, strict=True)):
        if cut:
            # As the database begins: y between -90° and 90°.
            followed[frame] = one if abs(one[2]) <= np.pi / 2 else two
        else:
            before = followed[frame - 1]
            near = [angles + _TURN * np.round((before - angles) / _TURN) for angles in (one, two)]
            followed[frame] = min(near, key=lambda angles: np.sum((angles - before) ** 2))
    z, x, y = followed.T
    return Rotation.from_euler("ZYX", np.stack([z, y, x], axis=1))
