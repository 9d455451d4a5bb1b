"""From positions to a motion: the rotations of bones of fixed length that fit them best.

A network returns positions; a file needs rotations. From the hips down, each joint is rotated so
that its bones point as the positions say. One bone leaves its twist undetermined, which is taken
from the parent joint; several bones (hips, chest) are fitted together.
"""

import numpy as np

from numpy_cae.motion.joints import JOINTS, PARENTS, REST_DIRECTIONS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import IDENTITY, inverse, product, rotate
from numpy_cae.motion.retarget.rotations import fit_fan, swing
from numpy_cae.motion.skeleton import Skeleton

_TIPS = {
    "head": (0.0, 0.18, 0.0),
    "left_wrist": (0.16, 0.0, 0.0),
    "right_wrist": (-0.16, 0.0, 0.0),
    "left_toe": (0.0, 0.0, 0.06),
    "right_toe": (0.0, 0.0, 0.06),
}

_TAU = 1e-7
"""τ of `fit_fan`: only what the bones leave undetermined stays near the T-pose."""


def body_skeleton(lengths: np.ndarray) -> Skeleton:
    """The twenty joints as a skeleton in a T-pose facing +Z, from (20,) bone lengths in metres."""
    norms = np.linalg.norm(REST_DIRECTIONS, axis=1)
    directions = REST_DIRECTIONS / np.maximum(norms, 1e-9)[:, None]
    tips = {JOINTS.index(joint): np.array(tip) for joint, tip in _TIPS.items()}
    return Skeleton(JOINTS, PARENTS, directions * lengths[:, None], tips)


def fit_motion(
    positions: np.ndarray, lengths: np.ndarray, rate: float, unit: float = 0.01
) -> Motion:
    """A motion of the twenty joints on bones of these lengths that fits the positions.

    Where one bone leaves a joint its direction is kept exactly; where several do, the angles
    between them become their mean over the take.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    lengths : (20,) array of float
        In metres.
    rate, unit : float
        Frames a second, and metres in one unit of the file to be written.

    Returns
    -------
    Motion

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.motion import RATE, body_of, bone_lengths
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> motion = fit_motion(walk, bone_lengths(walk), RATE)
    >>> bool(np.abs(motion.positions() - walk).max() < 0.01)
    True
    """
    skeleton = body_skeleton(lengths)
    rotations = np.tile(IDENTITY, (len(positions), len(JOINTS), 1))
    turned = rotations.copy()
    for joint, parent in enumerate(PARENTS):
        above = turned[:, max(parent, 0)].copy()
        ends = [end for end in skeleton.children(joint) if lengths[end] > 0]
        bones = positions[:, ends] - positions[:, [joint]]
        rotation = above
        if len(ends) == 1:
            rest = rotate(above, skeleton.offsets[ends[0]])
            rotation = product(swing(rest, bones[:, 0]), above)
        elif ends:
            rotation, skeleton.offsets[ends] = _fit(bones, skeleton.offsets[ends], above)
        turned[:, joint] = rotation
        rotations[:, joint] = product(inverse(above), rotation)
    translations = np.repeat(skeleton.offsets[None], len(positions), axis=0)
    translations[:, 0] = positions[:, 0]
    return Motion(skeleton, rate, rotations, translations, unit, f"{unit:g} m")


def _fit(bones: np.ndarray, rest: np.ndarray, above: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rotations (F) that fit rigid bones `rest` (N, 3) to `bones` (F, N, 3), and the bones.

    A body's bones differ from the T-pose's: after a fit the mean directions replace them.
    """

    def rotations() -> np.ndarray:
        return product(fit_fan(rotate(above[:, None], rest), bones, _TAU), above)

    lengths = np.linalg.norm(rest, axis=1, keepdims=True)
    for _ in range(2):
        mean = rotate(inverse(rotations())[:, None], bones).mean(axis=0)
        rest = mean / np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12) * lengths
    return rotations(), rest
