"""Rotations that align the direction of one bone, or of several bones of one joint (a fan).

The smallest rotation of one bone from direction a to b is about a × b, by the angle between the
two; it keeps the bone's twist. For a fan, from bones a_i to b_i, the rotation R that minimises

    Σ_i |b_i - R a_i|²      is the rotation nearest to Σ_i b_i a_iᵀ.

The regularisation adds τ Σ_i |a_i|² to the diagonal of that sum, so that the rotation stays small
about an axis that the bones determine poorly. A second pass, from the result of the first, restores
most of what the regularisation removed from a well determined rotation.
Rotations are quaternions (F, 4).
"""

import numpy as np

from numpy_cae.motion.quaternions import from_vector, nearest, product, rotate


def swing(before: np.ndarray, after: np.ndarray, share: float = 1.0) -> np.ndarray:
    """The smallest rotations (F) from the directions `before` (F, 3) to the directions `after`.

    The vectors may have any length; the rotation is exactly the identity where they are the same or
    one is zero. `share` is the part of the angle to rotate by.
    """
    before, after = _unit(before), _unit(after)
    axis = np.cross(before, after)
    sine = np.linalg.norm(axis, axis=-1)
    cosine = np.sum(before * after, axis=-1)
    # For opposite directions the axis is not unique: take any perpendicular one.
    other = np.where(np.abs(before[:, [0]]) < 0.9, [1.0, 0, 0], [0, 1.0, 0])
    opposite = np.where(cosine[:, None] < 0, np.cross(before, other), 0.0)
    axis = np.where(sine[:, None] > 1e-9, axis, opposite)
    return from_vector(_unit(axis) * (share * np.arctan2(sine, cosine))[:, None])


def fit_fan(before: np.ndarray, after: np.ndarray, tau: float) -> np.ndarray:
    """The rotations (F) that align each frame's bones `before` (F, N, 3) with `after`.

    Long bones have more weight than short ones, and bones of length 0 none. `tau` above 0 is the
    strength of the regularisation, τ.
    """
    first = _regularised_fit(before, after, tau)
    return product(_regularised_fit(rotate(first[:, None], before), after, tau), first)


def _regularised_fit(before: np.ndarray, after: np.ndarray, tau: float) -> np.ndarray:
    diagonal = tau * np.sum(before**2, axis=(1, 2))[:, None, None] + 1e-300
    return nearest(after.transpose(0, 2, 1) @ before + diagonal * np.eye(3))


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)
