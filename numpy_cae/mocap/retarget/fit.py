"""Find the motion of bones of fixed lengths that fits positions best.

A network returns positions, but a file needs rotations. From the hips down, each joint is rotated
so that its bones have the directions that the positions give. A single bone does not determine the
joint's twist, which is then taken from the parent joint. If several bones begin at a joint (hips,
chest), they are fitted together.
"""

import numpy as np

from numpy_cae.mocap.retarget.rotations import fit_fan, swing
from numpy_cae.motion.joints import JOINTS, PARENTS, REST_DIRECTIONS, REST_TIPS
from numpy_cae.motion.motion import Motion, Note, Skeleton
from numpy_cae.motion.quaternions import IDENTITY, inverse, product, rotate

_TAU = 1e-7
"""τ of `fit_fan`. It is so small that only rotations that the bones do not determine stay near the
T-pose."""


def body_skeleton(lengths: np.ndarray) -> Skeleton:
    """The twenty joints as a skeleton in a T-pose facing +Z, from (20,) bone lengths in metres."""
    norms = np.linalg.norm(REST_DIRECTIONS, axis=1)
    directions = REST_DIRECTIONS / np.maximum(norms, 1e-9)[:, None]
    return Skeleton(JOINTS, PARENTS, directions * lengths[:, None], dict(REST_TIPS))


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
        rest = mean / np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12) * lengths
    return rotations(), rest
