"""Measures of world positions (F, 20, 3), in metres, of the twenty joints."""

import numpy as np

from numpy_cae.motion.joints import PARENTS

_BONES = [joint for joint, parent in enumerate(PARENTS) if parent >= 0]


def jitter(positions: np.ndarray, rate: float) -> float:
    """Mean over joints and frames of the acceleration's magnitude, in m/s².

        mean_{t,j} ‖p_{t+1,j} - 2 p_{t,j} + p_{t-1,j}‖ · rate²

    It is to be compared with the truth's, as it is not best at 0: noise that changes from frame to
    frame increases it far more than the position error, and too much smoothing decreases it.
    ValueError for fewer than 3 frames.
    """
    if np.ndim(positions) != 3 or np.shape(positions)[2] != 3 or len(positions) < 3:
        raise ValueError(
            f"positions have shape {np.shape(positions)}, expected (3 frames or more, joints, 3)"
        )
    acceleration = np.diff(np.asarray(positions, dtype=np.float64), 2, axis=0) * rate**2
    return float(np.linalg.norm(acceleration, axis=-1).mean())


def bone_length_error(positions: np.ndarray, lengths: np.ndarray) -> float:
    """Root mean square over bones and frames of the deviation from `lengths` (20,), centimetres.

        100 · √ mean_{t,j} (‖p_{t,j} - p_{t,parent(j)}‖ - l_j)²

    holden2015, section 7, names it as a limitation: "the manifold projection cannot guarantee
    constraints such as ground contact and joint lengths". Real bodies have an error too, where a
    bone spans joints that bend (the neck, between chest and head).
    """
    positions = np.asarray(positions, dtype=np.float64)
    bones = positions[:, _BONES] - positions[:, [PARENTS[joint] for joint in _BONES]]
    gap = np.linalg.norm(bones, axis=-1) - np.asarray(lengths)[_BONES]
    return float(100 * np.sqrt(np.mean(gap**2)))
