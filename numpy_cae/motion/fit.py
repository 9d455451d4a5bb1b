"""Find the motion of bones of fixed lengths that fits positions best.

A network returns positions, but a file needs rotations. From the hips down, each joint is rotated
so that its bones have the directions that the positions give. A single bone does not determine the
joint's twist, which is then taken from the parent joint. If several bones begin at a joint (hips,
chest, a fan), they are fitted together.

The smallest rotation of one bone from direction a to b is about a × b, by the angle between the
two; it keeps the bone's twist. For a fan, from bones a_i to b_i, the rotation R that minimises

    Σ_i |b_i - R a_i|²      is the rotation nearest to Σ_i b_i a_iᵀ.

The regularisation adds τ Σ_i |a_i|² to the diagonal of that sum, so that the rotation stays small
about an axis that the bones determine poorly. A second pass, from the result of the first, restores
most of what the regularisation removed from a well determined rotation.
Rotations are quaternions (F, 4).
"""

import numpy as np

from numpy_cae.motion.joints import JOINTS, PARENTS, REST_DIRECTIONS, REST_TIPS
from numpy_cae.motion.motion import Motion, Note, Skeleton
from numpy_cae.motion.quaternions import IDENTITY, from_vector, inverse, nearest, product, rotate

ROUNDING = 1e-9
"""A difference below this, in radians or in metres at a bone's end, changes nothing."""
_TAU = 1e-7
"""τ of `fit_fan`. It is so small that only rotations that the bones do not determine stay near the
T-pose."""


def body_skeleton(lengths: np.ndarray) -> Skeleton:
    """The twenty joints as a skeleton in a T-pose facing +Z, from (20,) bone lengths in metres."""
    offsets = unit_vectors(REST_DIRECTIONS) * lengths[:, None]
    return Skeleton(JOINTS, PARENTS, offsets, dict(REST_TIPS))


def fit_motion(positions: np.ndarray, lengths: np.ndarray, rate: float) -> Motion:
    """The motion of the twenty joints, on bones of these lengths, that fits the positions best.

    If a single bone begins at a joint, its direction is kept exactly. If several do, the angles
    between them become constant, with their mean over the take.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    lengths : (20,) array of float
        In metres.
    rate : float
        Frames a second.

    Returns
    -------
    Motion
        Written in centimetres.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_of
    >>> from numpy_cae.motion import RATE, bone_lengths
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> motion = fit_motion(walk, bone_lengths(walk), RATE)
    >>> bool(np.abs(motion.positions() - walk).max() < 0.01)
    True
    """
    skeleton = body_skeleton(lengths)
    rotations = np.tile(IDENTITY, (len(positions), len(JOINTS), 1))
    turned = rotations.copy()
    for joint, parent in enumerate(PARENTS):
        before = turned[:, max(parent, 0)].copy()  # as the parent is rotated
        ends = [end for end in skeleton.children(joint) if lengths[end] > 0]
        bones = positions[:, ends] - positions[:, [joint]]
        rotation = before
        if len(ends) == 1:
            rest = rotate(before, skeleton.offsets[ends[0]])
            rotation = product(swing(rest, bones[:, 0]), before)
        elif ends:
            rotation, skeleton.offsets[ends] = _fit(bones, skeleton.offsets[ends], before)
        turned[:, joint] = rotation
        rotations[:, joint] = product(inverse(before), rotation)
    translations = np.repeat(skeleton.offsets[None], len(positions), axis=0)
    translations[:, 0] = positions[:, 0]
    return Motion(skeleton, rate, rotations, translations, 0.01, (Note("unit", "centimetres"),))


def _fit(bones: np.ndarray, rest: np.ndarray, before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rotations (F) that fit rigid bones to `bones` (F, N, 3), and these rigid bones (N, 3).

    A body's bones have other directions than the T-pose's, `rest` (N, 3). After each fit their mean
    directions replace those of `rest`.
    """

    def rotations() -> np.ndarray:
        return product(fit_fan(rotate(before[:, None], rest), bones, _TAU), before)

    lengths = np.linalg.norm(rest, axis=1, keepdims=True)
    for _ in range(2):
        mean = rotate(inverse(rotations())[:, None], bones).mean(axis=0)
        rest = unit_vectors(mean) * lengths
    return rotations(), rest


def swing(before: np.ndarray, after: np.ndarray, share: float = 1.0) -> np.ndarray:
    """The smallest rotations (F) from the directions `before` (F, 3) to the directions `after`.

    The vectors may have any length; the rotation is exactly the identity where they are the same or
    one is zero. `share` is the part of the angle to rotate by.
    """
    before = unit_vectors(before)
    after = unit_vectors(after)
    axis = np.cross(before, after)
    sine = np.linalg.norm(axis, axis=-1)
    cosine = np.sum(before * after, axis=-1)
    # For opposite directions the axis is not unique: take any perpendicular one.
    x_or_y = np.where(np.abs(before[:, [0]]) < 0.9, [1.0, 0, 0], [0, 1.0, 0])
    opposite = np.where(cosine[:, None] < 0, np.cross(before, x_or_y), 0.0)
    axis = np.where(sine[:, None] > 1e-9, axis, opposite)
    return from_vector(unit_vectors(axis) * (share * np.arctan2(sine, cosine))[:, None])


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


def unit_vectors(vectors: np.ndarray) -> np.ndarray:
    """Vectors (…, 3) divided by their lengths; zero stays zero."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)


def bend_limb(
    start: np.ndarray, chain: np.ndarray, middle: np.ndarray, end: np.ndarray
) -> np.ndarray:
    """The point nearest to `middle` from which a limb that begins at `start` reaches `end`.

    Let a and b be the lengths of its two bones, which `chain` (F, 3 joints, 3) gives before the
    change, and d the distance from `start` to `end`. The points are a circle about the line from
    start to end, at x = (a² - b² + d²) / 2d along the line, with radius √(a² - x²). Where the end
    is too far away or too near, the circle is a point on the line.
    """
    a, b = np.linalg.norm(np.diff(chain, axis=1), axis=-1).T
    d = np.linalg.norm(end - start, axis=-1)
    line = (end - start) / np.maximum(d, 1e-12)[:, None]
    x = np.clip((a**2 - b**2 + d**2) / np.maximum(2 * d, 1e-12), -a, a)

    def off_line(vectors: np.ndarray) -> np.ndarray:
        return vectors - np.sum(vectors * line, axis=-1, keepdims=True) * line

    outward = off_line(middle - start)
    near_line = np.linalg.norm(outward, axis=-1, keepdims=True) < 1e-6
    outward = unit_vectors(np.where(near_line, off_line(chain[:, 1] - chain[:, 0]), outward))
    reached = start + x[:, None] * line + np.sqrt(a**2 - x**2)[:, None] * outward
    unchanged = np.abs(np.stack([start, middle, end], axis=1) - chain).max(axis=(1, 2)) < ROUNDING
    return np.where(unchanged[:, None], middle, reached)
