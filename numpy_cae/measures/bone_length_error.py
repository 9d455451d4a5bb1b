"""Deviation of bones from their lengths: on the manifold a body may stretch."""

import numpy as np

from numpy_cae.motion.joints import JOINTS, PARENTS

_BONES = [joint for joint, parent in enumerate(PARENTS) if parent >= 0]


def bone_length_error(positions: np.ndarray, lengths: np.ndarray) -> float:
    """Root mean square over bones and frames, in centimetres.

        100 · √ mean_{t,j} (‖p_{t,j} - p_{t,parent(j)}‖ - l_j)²

    holden2015, section 7, names it as a limitation: "the manifold projection cannot guarantee
    constraints such as ground contact and joint lengths". Real bodies have an error too, where a
    bone spans joints that bend (the neck, between chest and head).

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        In metres.
    lengths : (20,) array of float
        The body's, in metres, as `numpy_cae.motion.bone_lengths` gives them.

    Raises
    ------
    ValueError
        If the positions are not those of the twenty joints.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.ndim != 3 or positions.shape[1:] != (len(JOINTS), 3) or len(positions) == 0:
        raise ValueError(f"positions have shape {positions.shape}, expected (frames, 20, 3)")
    bones = positions[:, _BONES] - positions[:, [PARENTS[joint] for joint in _BONES]]
    gap = np.linalg.norm(bones, axis=-1) - np.asarray(lengths)[_BONES]
    return float(100 * np.sqrt(np.mean(gap**2)))
