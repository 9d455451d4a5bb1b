"""Bones set exactly to given lengths, each in its own direction."""

import numpy as np

from numpy_cae.motion.features import POSITIONS, local_positions
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.ops.shapes import Pullback

_SHORTEST = 1e-9
"""Lengths (m) below this count as this, so that no bone is divided by zero."""


def exact_lengths(features: np.ndarray, lengths: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """Set the length of every bone, from the hips outwards, and return the pullback of that.

        b_j = q_j - q_parent,   e_j = e_parent + l_j b_j / |b_j|

    The pullback goes from the ends of the limbs inwards. D_j is the sum of de over j and all joints
    below it in the skeleton:

        db_j = l_j / |b_j| · (D_j - u (u · D_j)),   u = b_j / |b_j|
        dq_j += db_j,   dq_parent -= db_j,   dq_hips += D_hips

    Parameters
    ----------
    features : (F, 63) array of float
    lengths : (20,) array of float
        l of the bone that ends at each joint, metres.

    Returns
    -------
    exact : (F, 63) array of float64
        The hips, velocities and turns are unchanged.
    pullback : d_exact -> d_features
    """
    features = np.asarray(features, np.float64)
    q = local_positions(features)
    e = q.copy()
    unit = np.zeros_like(q)
    ratio = np.zeros((*q.shape[:2], 1))
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            bone = q[:, joint] - q[:, parent]
            length = np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), _SHORTEST)
            unit[:, joint] = bone / length
            ratio[:, joint] = lengths[joint] / length
            e[:, joint] = e[:, parent] + lengths[joint] * unit[:, joint]
    exact = features.copy()
    exact[:, POSITIONS] = e.reshape(len(q), -1)

    def pullback(d_exact: np.ndarray) -> np.ndarray:
        d_below = d_exact[:, POSITIONS].reshape(q.shape).copy()
        dq = np.zeros_like(q)
        for joint in reversed(range(len(JOINTS))):
            parent = PARENTS[joint]
            if parent < 0:
                dq[:, joint] += d_below[:, joint]
                continue
            d = d_below[:, joint]
            u = unit[:, joint]
            d_bone = ratio[:, joint] * (d - u * np.sum(u * d, axis=-1, keepdims=True))
            dq[:, joint] += d_bone
            dq[:, parent] -= d_bone
            d_below[:, parent] += d
        d_features = d_exact.copy()
        d_features[:, POSITIONS] = dq.reshape(len(q), -1)
        return d_features

    return exact, pullback
