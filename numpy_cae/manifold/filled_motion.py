"""`fill` for someone with a file in hand: what is missing from a motion of any rig, filled in.

What was observed stays observed: a filled joint moves alone, keyframes are kept to the bit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from numpy_cae.baselines import PCA
from numpy_cae.manifold.fill import between, eased, fill_between, fill_joint, require_joint
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import RootTransform, features_to_positions, joint_slice
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import Motion, slerp
from numpy_cae.motion.retarget.rigs import body_positions
from numpy_cae.motion.retarget.to_body import RATE, at_rate_of, body_of
from numpy_cae.motion.retarget.to_rig import moves_alone, retarget


def fill_motion_joint(
    motion: Motion,
    manifold: MotionManifold,
    joint: str,
    mapping: dict[str, str] | None = None,
    frames: tuple[int, int] | None = None,
    fit: bool = False,
    poses: PCA | None = None,
) -> Motion:
    """The motion with one joint where the manifold has it, whatever the file says of it.

    Observed are the other nineteen joints and the lengths of all bones. A joint at the end of a
    limb goes in the direction that the manifold gives it. One in between, such as an elbow, can
    only be on a circle about the line between its neighbours; it goes to the point of
    it that is nearest to the manifold's. Rotations change only in the joints whose bones then
    point elsewhere (for a wrist, the elbow's); what hangs from them is carried along. What the
    file says of a joint at the end has no part in this; of one in between it has a small one, in
    the heading (shoulders) and in how its bones are brought to the mean skeleton's lengths.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    manifold : MotionManifold
    joint : str
        One of `numpy_cae.motion.JOINTS`, such as "left_wrist".
    mapping : dict of our joint names to the rig's, optional
    frames : (first, last), optional
        In which the joint is missing, of the file, from 0, both included; all where None.
    fit : bool
        Look for the motion that fits what was observed, `project_observed`, rather than project
        once with the mean pose for the unknown, as in the paper.
    poses : PCA, optional
        With `fit`: what `project_observed` may start from.

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    ValueError
        If there are no such frames, no such joint, or in this rig it cannot move while the others
        stay.
    """
    place = JOINTS.index(require_joint(joint))
    positions = body_of(motion, mapping)
    if not moves_alone(motion, joint, mapping):
        movable = [name for name in JOINTS if moves_alone(motion, name, mapping)]
        raise ValueError(
            f"{joint} sits stiffly between its neighbours in this rig and cannot be filled "
            f"without moving them; {', '.join(movable)} can"
        )
    first, last = frames or (0, len(motion) - 1)
    if not 0 <= first <= last < len(motion):
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {len(motion) - 1}")
    features, start = manifold.features(positions)
    moments = motion.source_frames(RATE)
    missing = (moments > first - 1) & (moments < last + 1)
    filled = _filled(manifold, features, joint, missing, fit, poses)
    filled = _on_own_bones(manifold, filled, start, positions)
    asked = body_positions(motion, mapping)
    wanted = at_rate_of(motion, filled[:, [place]])[:, 0]
    neighbours = [n for n in range(len(JOINTS)) if PARENTS[n] == place]
    if neighbours:
        above, below = asked[:, PARENTS[place]], asked[:, neighbours[0]]
        wanted = _on_circle(wanted, asked[:, place], above, below)
    asked[first : last + 1, place] = wanted[first : last + 1]
    return retarget(motion, asked, mapping)


def _filled(
    manifold: MotionManifold,
    features: np.ndarray,
    joint: str,
    missing: np.ndarray,
    fit: bool,
    poses: PCA | None,
) -> np.ndarray:
    """Features with the joint filled in the poses in which it is missing, (F,) bool."""
    if fit:
        from numpy_cae.beyond.observed import project_observed

        known = np.ones(features.shape, bool)
        known[missing, joint_slice(joint)] = False
        return project_observed(manifold, features, known, poses=poses)
    unknown = features.copy()
    unknown[missing, joint_slice(joint)] = np.nan
    return fill_joint(manifold, unknown, joint) if missing.any() else features


def fill_motion_keyframes(
    motion: Motion, manifold: MotionManifold, every: int, mapping: dict[str, str] | None = None
) -> Motion:
    """The motion with what the manifold has between keyframes, whatever the file has there.

    Observed are frames 0, n, 2n, … of the file, which are kept to the bit. What positions do not
    say (twists, fingers) turns from one keyframe to the next along the shortest way.
    After the last keyframe its pose is held.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate: stepped, or whole.
    manifold : MotionManifold
    every : int
        Frames of the file from one keyframe to the next.
    mapping : dict of our joint names to the rig's, optional

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    ValueError
        If `every` is below 1.
    """
    if every < 1:
        raise ValueError(f"keyframes every {every} frames, expected 1 or more")
    keys = np.arange(0, len(motion), every)
    base = _from_key_to_key(motion, keys)
    positions = body_of(base, mapping)
    moments = base.source_frames(RATE)
    nearest = np.unique([np.abs(moments - key).argmin() for key in keys])
    features, start = manifold.features(positions)
    filled = _on_own_bones(manifold, fill_between(manifold, features, nearest), start, positions)
    asked = at_rate_of(base, filled)
    known = body_positions(base, mapping)[keys]
    asked += eased(known - asked[keys], keys, len(motion))
    asked[keys] = known
    return retarget(base, asked, mapping)


def _on_own_bones(
    manifold: MotionManifold, features: np.ndarray, start: RootTransform, own: np.ndarray
) -> np.ndarray:
    """World positions of features, on the bones of the body at `own` (F, 20, 3)."""
    positions = features_to_positions(features, start)
    return change_lengths(positions, manifold.lengths, bone_lengths(own))


def _on_circle(
    wanted: np.ndarray, own: np.ndarray, above: np.ndarray, below: np.ndarray
) -> np.ndarray:
    """The point nearest to `wanted` at the distances that `own` has from `above` and `below`.

    The points at both distances are a circle about the line from one neighbour to the other: its
    middle is the foot of `own` on that line, its radius how far `own` is from there. All (F, 3).
    """
    line = below - above
    line = line / np.maximum(np.linalg.norm(line, axis=-1, keepdims=True), 1e-12)

    def off_line(points: np.ndarray) -> np.ndarray:
        return points - above - np.sum((points - above) * line, axis=-1, keepdims=True) * line

    radius = np.linalg.norm(off_line(own), axis=-1, keepdims=True)
    outward = off_line(wanted)
    away = np.linalg.norm(outward, axis=-1, keepdims=True)
    outward = np.where(away > 1e-6, outward / np.maximum(away, 1e-12) * radius, off_line(own))
    return own - off_line(own) + outward


def _from_key_to_key(motion: Motion, keys: np.ndarray) -> Motion:
    """Frames in between made anew: rotations by the shortest way, translations along a line."""
    frames = np.arange(len(motion))
    rotations = slerp(keys, motion.rotations[keys], frames)
    rotations[keys] = motion.rotations[keys]
    translations = between(motion.translations[keys], keys, len(motion))
    translations[keys] = motion.translations[keys]
    return replace(motion, rotations=rotations, translations=translations)
