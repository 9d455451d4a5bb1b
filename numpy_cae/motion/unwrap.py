"""Rotation vectors without jumps.

v and v - 2πk v/|v| are the same rotation for every whole k, and what reads rotations from a file
gives the one shorter than π. A joint that turns through π thus jumps to the other side of the
ball; a network would have to learn that jump. Here each frame takes that one of the equals which
is nearest to the frame before (as MBR17 and Grassia, 1998, do).
"""

from __future__ import annotations

import numpy as np

_TURN = 2 * np.pi
# Below this length a direction is only rounding.
_SHORT = 1e-9


def unwrapped(vectors: np.ndarray) -> np.ndarray:
    """The same rotations, continuous in time.

    Parameters
    ----------
    vectors : (F, …, 3) array of float64
        Rotation vectors, in radians; each but the first frame is replaced by its equal that is
        nearest to the frame before.

    Returns
    -------
    (F, …, 3) array of float64
    """
    smooth = np.array(vectors, dtype=np.float64)
    for frame in range(1, len(smooth)):
        smooth[frame] = _nearest(smooth[frame], smooth[frame - 1])
    return smooth


def _nearest(vector: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Of the rotation vectors equal to `vector`, (…, 3), the one nearest to `before`."""
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    # The equals lie on one line. Where the rotation is none, that line may have any direction
    # (2π about whatever axis); the one of the frame before keeps the way straight.
    axis = np.where(angle > _SHORT, vector, before)
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = axis / np.where(length > _SHORT, length, 1.0)
    turns = np.round((np.sum(before * axis, axis=-1, keepdims=True) - angle) / _TURN)
    return vector + _TURN * turns * axis


def nearest_turn(vectors: np.ndarray) -> np.ndarray:
    """Continuous rotation vectors of clips, as a whole moved to their equals nearest to none.

    A person who turned about once has every vector longer by 2π from there on; a clip of later
    should not differ from a clip of before. Over a clip the number of turns is one for each joint,
    so that it stays as continuous as it was.

    Parameters
    ----------
    vectors : (…, F, J, 3) array of float
        Unwrapped.
    """
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    turns = np.round(angle.mean(axis=-3, keepdims=True) / _TURN)
    if not turns.any():
        return vectors
    return vectors * (1 - _TURN * turns / np.where(angle > _SHORT, angle, 1.0))
