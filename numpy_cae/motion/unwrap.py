"""Rotation vectors without jumps.

v and v - 2πk v/|v| are the same rotation for every integer k, and a conversion returns the vector
shorter than π. When a joint rotates through π, its vector thus jumps to the opposite side of the
ball, and a network would have to learn that jump. Here each frame gets the equivalent vector
nearest to the frame before (as in MBR17 and Grassia, 1998).
"""

import numpy as np

_PERIOD = 2 * np.pi
# Below this length the direction of a vector is rounding error.
_SHORT = 1e-9


def unwrapped(vectors: np.ndarray) -> np.ndarray:
    """The same rotations, continuous in time: rotation vectors (F, …, 3) in radians, of which each
    but the first frame is replaced by the equivalent vector nearest to the frame before.
    """
    smooth = np.array(vectors, dtype=np.float64)
    for frame in range(1, len(smooth)):
        smooth[frame] = _nearest(smooth[frame], smooth[frame - 1])
    return smooth


def _nearest(vector: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Of the vectors (…, 3) equivalent to `vector`, the one nearest to `before`."""
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    # Equivalent vectors lie on one line. For no rotation that line may have any direction (2π
    # about any axis); the direction of the frame before keeps the trajectory straight.
    axis = np.where(angle > _SHORT, vector, before)
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = axis / np.where(length > _SHORT, length, 1.0)
    turns = np.round((np.sum(before * axis, axis=-1, keepdims=True) - angle) / _PERIOD)
    return vector + _PERIOD * turns * axis


def shortest_clips(vectors: np.ndarray) -> np.ndarray:
    """Continuous rotation vectors (…, F, J, 3) of clips, shifted by whole turns to the shortest.

    After a person has turned round once, every vector is longer by 2π; later clips should not
    differ from earlier ones. The shift is one number for each joint and clip, so that the clip
    stays continuous.
    """
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    turns = np.round(angle.mean(axis=-3, keepdims=True) / _PERIOD)
    if not turns.any():
        return vectors
    return vectors * (1 - _PERIOD * turns / np.where(angle > _SHORT, angle, 1.0))
