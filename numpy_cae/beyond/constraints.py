"""Constraints on a motion, each as a loss and its pullback.

holden2015, section 7: "Currently the manifold projection cannot guarantee constraints such as
ground contact and joint lengths." Each function returns the mean squared error of one constraint,
in squared metres, and its pullback to the features (F, 63). All but positions in the world can be
computed in the body's frame, from one frame to the next; positions in the world are sums of
velocities, and their pullback sums gradients from the last frame backwards.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae.motion.contacts import FEET
from numpy_cae.motion.features import (
    POSITIONS,
    TURN,
    VELOCITY,
    RootTransform,
    features_to_positions,
)
from numpy_cae.motion.heading import rotate_on_floor
from numpy_cae.motion.joints import JOINTS, PARENTS

CENTIMETRES = 1e4
"""Squared centimetres in a square metre: multiplied by this, an error of a centimetre is 1."""

Pullback = Callable[..., np.ndarray]
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
    q = features[:, POSITIONS].reshape(-1, len(JOINTS), 3)
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
    q = features[:, POSITIONS].reshape(-1, len(JOINTS), 3)
    feet = q[:, FEET][..., [_X, _Z]]
    velocity, turn = features[:-1, None, VELOCITY], features[:-1, TURN]
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
    q = features[:, POSITIONS].reshape(-1, len(JOINTS), 3)
    depth = np.maximum(0.0, ground - q[..., 1])

    def pullback(dloss: float = 1.0) -> np.ndarray:
        dq = np.zeros_like(q)
        dq[..., 1] = dloss * -2 * depth / depth.size
        return _only_positions(features, dq)

    return float(np.mean(depth**2)), pullback


def squared_difference(
    features: np.ndarray, target: np.ndarray, weights: np.ndarray
) -> tuple[float, Pullback]:
    """L = Σ w (f - f*)² / Σ w, the weighted squared difference from target features f*.

    Parameters
    ----------
    features, target, weights : (F, 63) arrays of float
        A weight of 0 leaves an entry free.
    """
    gap = features - target
    total = max(float(weights.sum()), 1e-12)

    def pullback(dloss: float = 1.0) -> np.ndarray:
        return dloss * 2 * weights * gap / total

    return float(np.sum(weights * gap**2) / total), pullback


def pin_error(
    features: np.ndarray,
    start: RootTransform,
    targets: np.ndarray,
    weights: np.ndarray,
    body: np.ndarray | None = None,
) -> tuple[float, Pullback]:
    """L = Σ w |M p - p*|² / Σ w over world positions p: a hand at a point, hips on a path.

    M maps the joints of the mean skeleton to those of another body; g = Mᵀ dL/d(Mp). Positions
    are sums of velocities and turns (`features_to_positions`), so a gradient g reaches every
    earlier frame, in sums that run backwards:

        dq_t = R(-θ_t) Σ_j g_{t,j}
        G_t = Σ_{s>t} Σ_j g_{s,j},           dv_t = R(-θ_t) G_t
        dθ_t = Σ_j g_{t,j} · R'(θ_t) q_{t,j} + G_t · R'(θ_t) v_t
        dω_t = Σ_{s>t} dθ_s

    Parameters
    ----------
    features : (F, 63) array of float
    start : RootTransform
        Of the first frame.
    targets : (F, 20, 3) array of float
        p*, metres; ignored where the weight is 0.
    weights : (F, 20) array of float, or (F, 20, 3) where coordinates differ
    body : (20, 20) array of float, optional
        M, the identity where None.
    """
    positions = features_to_positions(features, start)
    reached = positions if body is None else np.einsum("jk,fkx->fjx", body, positions)
    weights = np.broadcast_to(weights.T, targets.T.shape).T
    gap = np.where(weights > 0, reached - targets, 0.0)
    total = max(float(weights.sum()) / 3, 1e-12)
    theta = start.heading + np.concatenate([[0.0], np.cumsum(features[:-1, TURN.start])])

    def pullback(dloss: float = 1.0) -> np.ndarray:
        g = dloss * 2 / total * weights * gap
        g = g if body is None else np.einsum("jk,fjx->fkx", body, g)
        flat, angle = g[..., [_X, _Z]], theta[:, None]
        local = positions[..., [_X, _Z]] - _floor(features, start, theta)[:, None]  # R(θ) q
        dq = g.copy()
        dq[..., [_X, _Z]] = rotate_on_floor(flat, -angle)
        later = _sum_of_later(flat.sum(axis=1))
        step = rotate_on_floor(features[:, None, VELOCITY], angle)[:, 0]  # R(θ) v
        d_theta = np.sum(flat * _quarter_turned(local), axis=(1, 2))
        d_theta += np.sum(later * _quarter_turned(step), axis=1)
        d = _only_positions(features, dq)
        d[:-1, VELOCITY] = rotate_on_floor(later[:, None], -angle)[:-1, 0]
        d[:-1, TURN.start] = _sum_of_later(d_theta)[:-1]
        return d

    return float(np.sum(weights * gap**2) / total), pullback


def _only_positions(features: np.ndarray, dq: np.ndarray) -> np.ndarray:
    d = np.zeros_like(features)
    d[:, POSITIONS] = dq.reshape(len(features), -1)
    return d


def _floor(features: np.ndarray, start: RootTransform, theta: np.ndarray) -> np.ndarray:
    """h: where the hips stand, (F, 2)."""
    steps = rotate_on_floor(features[:-1, None, VELOCITY], theta[:-1, None])[:, 0]
    return np.array([start.x, start.z]) + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, 0)])


def _sum_of_later(values: np.ndarray) -> np.ndarray:
    """For each t the sum over all s > t."""
    return np.cumsum(values[::-1], axis=0)[::-1] - values


def _quarter_turned(vectors: np.ndarray) -> np.ndarray:
    """dR/dθ R⁻¹ of vectors (…, 2): (x, z) to (z, -x)."""
    return np.stack([vectors[..., 1], -vectors[..., 0]], axis=-1)
