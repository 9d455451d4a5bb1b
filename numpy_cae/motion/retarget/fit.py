"""Positions back to a motion: the turns of bones of fixed length that follow them best.

A network returns positions; a file wants rotations. Down the tree from the hips, each joint is
turned so that the bones that leave it point where the positions say. One bone leaves its twist
open, which is taken over from the joint above; several (hips, chest) are fitted together.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.joints import JOINTS, PARENTS, REST_DIRECTIONS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rotations import fan, swing
from numpy_cae.motion.skeleton import Skeleton

_TIPS = {
    "head": (0.0, 0.18, 0.0),
    "left_wrist": (0.16, 0.0, 0.0),
    "right_wrist": (-0.16, 0.0, 0.0),
    "left_toe": (0.0, 0.0, 0.06),
    "right_toe": (0.0, 0.0, 0.06),
}

_HOLD = 1e-7
"""τ of `fan`: a T-pose is no place to stay near to, so it settles only what is left open."""


def body_skeleton(lengths: np.ndarray) -> Skeleton:
    """The twenty joints as a skeleton in a T-pose, facing +Z.

    Parameters
    ----------
    lengths : (20,) array of float
        Of the bone that ends at each joint, metres.
    """
    along = REST_DIRECTIONS / np.maximum(np.linalg.norm(REST_DIRECTIONS, axis=1), 1e-9)[:, None]
    tips = {JOINTS.index(joint): np.array(tip) for joint, tip in _TIPS.items()}
    return Skeleton(JOINTS, PARENTS, along * lengths[:, None], tips)


def fit_motion(
    positions: np.ndarray, lengths: np.ndarray, rate: float, unit: float = 0.01
) -> Motion:
    """A motion of the twenty joints on bones of these lengths that follows the positions.

    Lengths become the given ones in every frame. Where one bone leaves a joint its direction is
    kept exactly; where several do, the angles between them become their mean over the take.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    lengths : (20,) array of float
        In metres.
    rate : float
        Frames a second.
    unit : float
        Metres in the unit that the motion is to be written in.

    Returns
    -------
    Motion
    """
    skeleton = body_skeleton(lengths)
    turned: list[Rotation] = []
    rotations = np.empty((len(positions), len(JOINTS), 4))
    for joint, parent in enumerate(PARENTS):
        above = Rotation.identity(len(positions)) if parent < 0 else turned[parent]
        ends = [end for end in skeleton.children(joint) if lengths[end] > 0]
        bones = positions[:, ends] - positions[:, [joint]]
        if len(ends) == 0:
            here = above
        elif len(ends) == 1:
            here = swing(above.apply(skeleton.offsets[ends[0]]), bones[:, 0]) * above
        else:
            here, skeleton.offsets[ends] = _fitted(bones, skeleton.offsets[ends], above)
        turned.append(here)
        rotations[:, joint] = (above.inv() * here).as_quat()
    translations = np.repeat(skeleton.offsets[None], len(positions), axis=0)
    translations[:, 0] = positions[:, 0]
    return Motion(skeleton, rate, rotations, translations, unit, f"{unit:g} m")


def _fitted(bones: np.ndarray, rest: np.ndarray, above: Rotation) -> tuple[Rotation, np.ndarray]:
    """Turns (F) of the rigid fan of bones `rest` (N, 3) that follow `bones` (F, N, 3) best.

    A body's fan is not the T-pose's: after a first fit the mean of what is seen replaces it.
    """
    lengths = np.linalg.norm(rest, axis=1, keepdims=True)
    for _ in range(2):
        turns = _turns(bones, rest, above)
        seen = np.mean([turn.inv().apply(bone) for turn, bone in zip(turns, bones, strict=True)], 0)
        rest = seen / np.maximum(np.linalg.norm(seen, axis=1, keepdims=True), 1e-12) * lengths
    return _turns(bones, rest, above), rest


def _turns(bones: np.ndarray, rest: np.ndarray, above: Rotation) -> Rotation:
    """From the joint above's rotation on, the turn that follows the bones best."""
    before = np.stack([above.apply(bone) for bone in rest], axis=1)
    return fan(before, bones, _HOLD) * above
