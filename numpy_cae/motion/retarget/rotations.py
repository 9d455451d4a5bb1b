"""The turns that bring directions to directions: of one bone, and of a fan of bones.

One bone, from a to b: the smallest rotation is about a × b, by the angle between the two; it
leaves the bone's twist as it was. A fan of bones a_i to b_i: the rotation R that minimises

    Σ_i |b_i - R a_i|²      R = U diag(1, 1, det UVᵀ) Vᵀ,   with Σ_i b_i a_iᵀ = U S Vᵀ

(Kabsch 1976). A diagonal τ Σ_i |a_i|² added to that sum is the wish not to turn: it settles what
the fan leaves open and damps what it hardly tells. A second pass, from where the first one led,
gives back most of what the wish held back of a turn that the fan does tell.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation


def swing(before: np.ndarray, after: np.ndarray, share: float = 1.0) -> Rotation:
    """The smallest rotations that bring the directions `before` to the directions `after`.

    Parameters
    ----------
    before, after : (F, 3) arrays of float
        Of any length; where one has none, nothing turns.
    share : float
        Of the angle to turn by.

    Returns
    -------
    Rotation of F
        Exactly none where the directions agree.
    """
    before, after = _unit(before), _unit(after)
    axis = np.cross(before, after)
    sine = np.linalg.norm(axis, axis=-1)
    cosine = np.sum(before * after, axis=-1)
    # Straight back there is no smallest turn; any axis square to the bone will do.
    square = np.cross(before, np.where(np.abs(before[:, [0]]) < 0.9, [1.0, 0, 0], [0, 1.0, 0]))
    axis = np.where(sine[:, None] > 1e-9, axis, np.where(cosine[:, None] < 0, square, 0.0))
    return Rotation.from_rotvec(_unit(axis) * (share * np.arctan2(sine, cosine))[:, None])


def fan(before: np.ndarray, after: np.ndarray, hold: float) -> Rotation:
    """The rotations that bring each frame's fan of bones `before` nearest to `after`.

    Parameters
    ----------
    before, after : (F, N, 3) arrays of float
        Long bones count more than short ones, and bones without length not at all.
    hold : float
        τ, above 0: the wish not to turn.

    Returns
    -------
    Rotation of F
        About an axis that the bones hardly tell, such as the line that all lie along, hardly any.
    """
    first = _held_fan(before, after, hold)
    ahead = np.stack([first.apply(bone) for bone in before.transpose(1, 0, 2)], axis=1)
    return _held_fan(ahead, after, hold) * first


def _held_fan(before: np.ndarray, after: np.ndarray, hold: float) -> Rotation:
    tie = hold * np.sum(before**2, axis=(1, 2))[:, None, None] + 1e-300
    u, _, vt = np.linalg.svd(after.transpose(0, 2, 1) @ before + tie * np.eye(3))
    u[:, :, 2] *= np.linalg.det(u @ vt)[:, None]  # else it could be a reflection
    return Rotation.from_matrix(u @ vt)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)
