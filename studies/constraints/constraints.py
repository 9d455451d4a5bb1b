"""Constraints on a motion, each as a loss and its pullback.

holden2015, section 7: "Currently the manifold projection cannot guarantee constraints such as
ground contact and joint lengths." Each function returns the mean squared error of one constraint,
in squared metres, and its pullback to the features (F, 63).
"""

import numpy as np

from numpy_cae.motion.contacts import FEET
from numpy_cae.motion.features import POSITIONS, TURN, VELOCITY, local_positions, rotate_on_floor
from numpy_cae.motion.joints import PARENTS
from numpy_cae.ops.shapes import Pullback

CENTIMETRES = 1e4
"""Squared centimetres in a square metre: multiplied by this, an error of a centimetre is 1."""

_X, _Z = (0, 2)
_ENDS = [joint for joint, parent in enumerate(PARENTS) if parent >= 0]
_STARTS = [PARENTS[joint] for joint in _ENDS]


def bone_length_error(features: np.ndarray, lengths: np.ndarray) -> tuple[float, Pullback]:
    """L = mean over bones and frames of (|b| - l)², with b = q_j - q_parent.

        dL/db = 2 (|b| - l) / N · b / |b|,    dq_j += db,    dq_parent -= db

    Parameters
    ----------
    features : (F, 63) array of float
    lengths : (20,) array of float
        l of the bone that ends at each joint, metres.
    """
    q = local_positions(features)
    bones = q[:, _ENDS] - q[:, _STARTS]
    measured = np.linalg.norm(bones, axis=-1, keepdims=True)
    gap = measured - np.asarray(lengths)[_ENDS][:, None]

    def pullback(dloss: float = 1.0) -> np.ndarray:
        d_bones = dloss * 2 * gap / gap.size * bones / np.maximum(measured, 1e-9)
        dq = np.zeros_like(q)
        for n, (end, start) in enumerate(zip(_ENDS, _STARTS, strict=True)):
            dq[:, end] += d_bones[:, n]
            dq[:, start] -= d_bones[:, n]
        return _only_positions(features, dq)

    return float(np.mean(gap**2)), pullback


def foot_sliding_error(features: np.ndarray, contacts: np.ndarray) -> tuple[float, Pullback]:
    """L = mean over contacts of |s_t|², s_t the step of a standing foot until the next frame.

    In the body's frame at t, with velocity v, turn ω and the foot's x and z in q:

        s_t = v_t + R(ω_t) q_{t+1} - q_t

        dv_t = ds_t,   dq_{t+1} = R(-ω_t) ds_t,   dq_t = -ds_t,   dω_t = ds_t · R'(ω_t) q_{t+1}

    Parameters
    ----------
    features : (F, 63) array of float
    contacts : (F, 2) array of bool
        Left and right; a foot must stay where both t and t + 1 are in contact.
    """
    q = local_positions(features)
    feet = q[:, FEET][..., [_X, _Z]]
    velocity = features[:-1, None, VELOCITY]
    turn = features[:-1, TURN]
    carried = rotate_on_floor(feet[1:], turn)
    stays = (contacts[1:] & contacts[:-1])[..., None]
    moved = stays * (velocity + carried - feet[:-1])
    count = max(int(stays.sum()), 1)

    def pullback(dloss: float = 1.0) -> np.ndarray:
        d_moved = dloss * 2 / count * moved
        d = np.zeros_like(features)
        d[:-1, VELOCITY] = d_moved.sum(axis=1)
        d[:-1, TURN.start] = np.sum(d_moved * _quarter_turned(carried), axis=(1, 2))
        dq = np.zeros_like(q)
        for n, foot in enumerate(FEET):
            dq[1:, foot, [_X, _Z]] += rotate_on_floor(d_moved, -turn)[:, n]
            dq[:-1, foot, [_X, _Z]] -= d_moved[:, n]
        return d + _only_positions(features, dq)

    return float(np.sum(moved**2) / count), pullback


def ground_penetration(features: np.ndarray, ground: float) -> tuple[float, Pullback]:
    """L = mean over joints and frames of max(0, ground - y)².   dL/dy = -2 max(0, ground - y) / N

    Parameters
    ----------
    features : (F, 63) array of float
    ground : float
        Height of the ground, metres.
    """
    q = local_positions(features)
    depth = np.maximum(0.0, ground - q[..., 1])

    def pullback(dloss: float = 1.0) -> np.ndarray:
        dq = np.zeros_like(q)
        dq[..., 1] = dloss * -2 * depth / depth.size
        return _only_positions(features, dq)

    return float(np.mean(depth**2)), pullback


def squared_difference(features: np.ndarray, target: np.ndarray) -> tuple[float, Pullback]:
    """L = mean of (f - f*)², the squared difference from target features f*, (F, 63)."""
    gap = features - target

    def pullback(dloss: float = 1.0) -> np.ndarray:
        return dloss * 2 / gap.size * gap

    return float(np.mean(gap**2)), pullback


def _only_positions(features: np.ndarray, dq: np.ndarray) -> np.ndarray:
    d = np.zeros_like(features)
    d[:, POSITIONS] = dq.reshape(len(features), -1)
    return d


def _quarter_turned(vectors: np.ndarray) -> np.ndarray:
    """dR/dθ R⁻¹ of vectors (…, 2): (x, z) to (z, -x)."""
    return np.stack([vectors[..., 1], -vectors[..., 0]], axis=-1)
