"""Measures of world positions (F, 20, 3), in metres, of the twenty joints."""

import numpy as np

from numpy_cae.evaluation.samples import jitter as jitter
from numpy_cae.motion.joints import PARENTS

_BONES = [joint for joint, parent in enumerate(PARENTS) if parent >= 0]


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
