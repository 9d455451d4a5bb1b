"""Retargeting: change a motion of any rig so that its twenty joints reach new positions.

A network changes positions, but the user's file has a rig with fingers, several joints in its neck
and rotations of its own. We start from the rotations of the original motion and change them as
little as possible. From the root down, each joint on a path between two of the twenty gets an extra
rotation Q_j,

    G'_j = Q_j · G'_parent · R_j

that points its bones at their targets. One bone gets the smallest rotation, which keeps its twist;
several bones of one joint (hips, chest) get one rotation that fits all. The n joints in between (a
second spine, a neck) share the rotation equally: joint i, counted from 0, makes 1 / (n - i) of the
remaining rotation, so a long spine bends evenly. No bone changes its length. Where the targets are
the present positions, nothing changes. All other joints keep R_j.

If a mask of touched joints is given, the targets of the other joints are their present positions.
A descendant of a touched joint is thus corrected to stay where it is, and frames without touched
joints are unchanged. Where a wrist or an ankle has to be reached exactly, the target of the elbow
or the knee is moved to the nearest point from which the wrist or ankle can be reached. These points
are a circle about the line from the beginning to the end of the limb.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.mocap.rigs.rigs import UnknownRigError
from numpy_cae.motion.fit import ROUNDING, bend_limb, fit_fan, swing
from numpy_cae.motion.hole_curves import remove_seams
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion, blocks
from numpy_cae.motion.quaternions import IDENTITY, angle, inverse, product, rotate

_MOVED = 1e-6
"""If the hips or an ancestor are further than this from their offset (m), their position channels
move the whole body."""

_FLEXIBLE_WEIGHT = 0.3
"""Weight in the fit of a bone with intermediate joints, as these can correct the rest."""

_TAU = 0.03
"""τ of `fit_fan`. Both collars of CMU's rig begin at one point, so all bones of its chest are
nearly on one line. About this line an error of a centimetre would rotate the chest by a right
angle. A larger τ suppresses requested rotations (docs/lab_book/retargeting.md)."""


_MIDDLES = [
    JOINTS.index(joint) for joint in ("left_elbow", "left_knee", "right_elbow", "right_knee")
]
"""Joints in the middle of a limb; the joint after each in `JOINTS` is the end of its limb."""


_Bone = tuple[int, ...]
"""The path along the rig from one of the twenty joints to the next, as indices of the rig."""
_Bones = dict[int, list[_Bone]]
"""For each joint of the rig that may rotate, the bones that begin at it or pass through it."""


def retarget(
    motion: Motion,
    positions: np.ndarray | Callable[[np.ndarray], np.ndarray],
    touched: np.ndarray | None = None,
    start: Motion | None = None,
) -> Motion:
    """The motion, changed as little as its twenty joints need to reach new positions.

    The hips reach their targets; other joints come as near as bones of constant length allow.
    Frames without touched joints and rotations that no touched joint needs are unchanged.

    Parameters
    ----------
    motion : Motion
        Any rate, and any rig in which the twenty joints can be found.
    positions : (frames, 20, 3) array of float
        Target world positions in metres, one pose for each frame of the motion at its own rate
        (`at_rate_of` resamples positions at 30 frames a second); or a function from frames
        (N,) to their poses (N, 20, 3): all poses of an hour would take 0.2 GB.
    touched : (frames, 20) array of bool, optional
        Joints that move to their targets; the others keep their positions as far as bones of
        constant length allow. Wrists and ankles keep theirs exactly, if necessary at the cost of
        the elbow or the knee. By default all joints are touched.
    start : Motion, optional
        The frames that have touched joints, with the rotations and translations that are changed as
        little as the positions need, such as those of `interpolate_joints`; by default those of
        `motion`.

    Returns
    -------
    Motion
        With the skeleton, rate and unit of `motion`.

    Raises
    ------
    ValueError
        If positions of touched joints are not finite or a shape does not fit the motion.
    UnknownRigError
        If joints are missing, or one of the twenty descends from none of the others.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_positions
    >>> walk = make_take("walk", 1, seconds=1.0, rate=30.0).motion
    >>> higher = retarget(walk, body_positions(walk) + [0.0, 0.1, 0.0])
    >>> (higher.positions() - walk.positions())[0, 0].round(3)
    array([0. , 0.1, 0. ])
    """
    joints = rig_of(motion).joints
    if touched is None:
        touched = np.ones((len(motion), len(JOINTS)), dtype=bool)
    _require_shapes(motion, positions, touched)
    bones = bones_through(motion, joints)
    changed = _start_motion(motion, touched, start, bones, joints)
    carrier = _carrier(motion, joints[0])
    for frames in blocks(np.flatnonzero(touched.any(axis=1))):
        moves = touched[frames]
        targets = _targets(motion, frames, positions, moves, joints)
        part = changed.at(frames)
        pose = part.forward_kinematics()
        if moves[:, 0].any():
            part.translations[:, carrier] += _step(part, pose, targets[:, 0], carrier, joints[0])
            changed.translations[frames] = part.translations
        by_joint = {joint: targets[:, index] for index, joint in enumerate(joints)}
        limbs = {joints[mid]: (joints[mid + 1], ~moves[:, mid + 1]) for mid in _MIDDLES}
        changed.rotations[frames] = _rotate_joints(part, pose, by_joint, limbs, bones)
    return changed


def _require_shapes(
    motion: Motion, positions: np.ndarray | Callable[[np.ndarray], np.ndarray], touched: np.ndarray
) -> None:
    """Raise ValueError if a shape does not fit the motion."""
    shape = (len(motion), len(JOINTS))
    if not callable(positions) and np.shape(positions) != (*shape, 3):
        raise ValueError(f"positions have shape {np.shape(positions)}, expected {(*shape, 3)}")
    if touched.shape != shape:
        raise ValueError(f"touched has shape {touched.shape}, expected {shape}")


def _targets(
    motion: Motion,
    frames: np.ndarray,
    positions: np.ndarray | Callable[[np.ndarray], np.ndarray],
    moves: np.ndarray,
    joints: list[int],
) -> np.ndarray:
    """Where the twenty joints go in some frames, (N, 20, 3): to `positions` where a joint `moves`
    (N, 20), else where the joint is. ValueError if a target is not finite."""
    new = positions(frames) if callable(positions) else positions[frames]
    if not np.all(np.isfinite(new).all(axis=-1) | ~moves):
        raise ValueError("positions hold values that are not finite")
    present = new if moves.all() else motion.at(frames).positions(joints)
    return np.where(moves[..., None], new, present)


def _start_motion(
    motion: Motion, touched: np.ndarray, start: Motion | None, bones: _Bones, joints: list[int]
) -> Motion:
    """A copy of the motion with the rotations and translations that are then changed as little as
    the positions need: those of `start`, and rotations without seams."""
    frames = touched.any(axis=1)
    rotations = motion.rotations.copy()
    translations = motion.translations
    moves = start is not None and np.any(start.translations != translations[frames])
    if touched[:, 0].any() or moves:
        translations = translations.copy()
    if start is not None:
        rotations[frames] = start.rotations
        if moves:
            translations[frames] = start.translations
    for joint, passing in bones.items():
        ends = touched[:, [joints.index(end) for *_, end in passing]]
        damaged = ends.any(axis=1)
        if start is not None:  # where every bone is damaged, the rotation of `start` has no seam
            damaged &= ~ends.all(axis=1)
        rotations[:, joint] = remove_seams(rotations[:, joint], np.asarray(damaged), motion.rate)
    return replace(motion, rotations=rotations, translations=translations)


_Pose = tuple[np.ndarray, np.ndarray]
"""Positions (F, J, 3) and global rotations (F, J, 4), as `forward_kinematics` returns them."""


def _step(motion: Motion, pose: _Pose, target: np.ndarray, carrier: int, hips: int) -> np.ndarray:
    """The change (F, 3) of the carrier's translation that moves the hips to their target (F, 3)."""
    positions, rotations = pose
    parent = motion.skeleton.parents[carrier]
    around = rotations[:, parent] if carrier else IDENTITY
    return rotate(inverse(around), target - positions[:, hips])


def _rotate_joints(
    motion: Motion,
    pose: _Pose,
    targets: dict[int, np.ndarray],
    limbs: dict[int, tuple[int, np.ndarray]],
    bones: _Bones,
) -> np.ndarray:
    """The rotations (F, J, 4) that point the bones at their targets, from the root down.

    `pose` is the motion's before its hips were moved; `targets` (F, 3) are by joints of the rig;
    `limbs` gives for an elbow or a knee the wrist or ankle and the frames (F) in which that keeps
    its position exactly.
    """
    before, rotations_before = pose
    rotations = motion.rotations.copy()
    after = motion.translations.copy()
    turned = motion.rotations.copy()  # becomes global, from the root down
    for joint, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            turned[:, joint] = product(turned[:, parent], turned[:, joint])
            after[:, joint] = after[:, parent] + rotate(turned[:, parent], after[:, joint])
        if joint not in bones:
            continue
        ends = [end for *_, end in bones[joint]]
        if ends[0] in limbs and len(ends) == 1:
            end, is_exact = limbs[ends[0]]
            chain = before[:, [joint, ends[0], end]]
            bent = bend_limb(after[:, joint], chain, targets[ends[0]], targets[end])
            targets[ends[0]] = np.where(is_exact[:, None], bent, targets[ends[0]])
        bone = np.stack([before[:, end] - before[:, joint] for end in ends], axis=1)
        target = np.stack([targets[end] - after[:, joint] for end in ends], axis=1)
        free = [_free_joints(path, joint, bones) for path in bones[joint]]
        corrected = _correct_rotation(
            turned[:, joint], rotations_before[:, joint], bone, target, free
        )
        changes = angle(product(corrected, inverse(turned[:, joint]))) > ROUNDING
        turned[changes, joint] = corrected[changes]
        if parent >= 0:
            corrected = product(inverse(turned[:, parent]), corrected)
        rotations[changes, joint] = corrected[changes]
    return rotations


def _correct_rotation(
    rotation: np.ndarray, before: np.ndarray, bone: np.ndarray, target: np.ndarray, free: list[int]
) -> np.ndarray:
    """The global rotation of a joint that points its bones at their targets.

    `rotation` is the joint's after the changes of its ancestors, `before` the unchanged one; `bone`
    and `target` (F, N, 3) are the unchanged bones and the vectors from the joint to the targets;
    `free` is the number of joints that share the rotation of each bone.
    """
    now = rotate(product(rotation, inverse(before))[:, None], bone)
    if len(free) == 1:
        return product(swing(now[:, 0], target[:, 0], 1 / free[0]), rotation)
    flexible = np.array(free) > 0
    weights = np.where(flexible, _FLEXIBLE_WEIGHT, 1.0)[:, None]
    fitted = product(fit_fan(now * weights, target, _TAU), rotation)
    # Where the targets are the unchanged bones, restore their rotation exactly.
    unchanged = np.all(np.abs(target - bone) < ROUNDING, axis=(1, 2))
    fitted = np.where(unchanged[:, None], before, fitted)
    # If only flexible bones miss, keep this joint's rotation: the joints inside these bones correct
    # them. If all bones are flexible, it rotates.
    decisive = np.ones(len(flexible), bool) if flexible.all() else ~flexible
    misses = np.linalg.norm(target - now, axis=-1) > ROUNDING
    return np.where(misses[:, decisive].any(axis=1)[:, None], fitted, rotation)


def moves_alone(motion: Motion, joint: str) -> bool:
    """Whether one of the twenty joints can move while all the others keep their positions.

    It can if some joint of the rig rotates only for the bone that ends at `joint`, and if at most
    one bone begins at `joint`. The hips and the chest cannot, as several bones begin there.
    Nor can a collar or a hip whose bone comes straight from them.
    """
    joints = rig_of(motion).joints
    bones = bones_through(motion, joints)
    index = joints[JOINTS.index(joint)]
    outgoing = [bone for bone in bones.get(index, []) if bone[0] == index]
    if len(outgoing) > 1:
        return False
    for group in bones.values():
        for bone in group:
            if bone[-1] == index and _free_joints(bone, bone[0], bones):
                return True
    return False


def bones_through(motion: Motion, joints: list[int]) -> _Bones:
    """The bones between the twenty joints, at each joint of the rig that may rotate.

    Raises UnknownRigError if one of the twenty descends from none of the others.
    """
    bones: _Bones = {}
    for name, joint in zip(JOINTS[1:], joints[1:], strict=True):
        path = motion.skeleton.path(joint)
        start = next((n for n, ancestor in enumerate(path) if n and ancestor in joints), 0)
        if not start:
            raise UnknownRigError(
                f"{name} ({motion.skeleton.names[joint]!r} in the rig) descends from none of the "
                "twenty joints: is another joint of the rig its hips? Name it in a mapping"
            )
        bone = tuple(path[start::-1])
        for passed in bone[:-1]:
            # A joint that never rotates (CMU's lhipjoint) is part of a rigid bone.
            rotates = np.abs(motion.rotations[:, passed, :3]).max() >= ROUNDING
            if passed == bone[0] or rotates:
                bones.setdefault(passed, []).append(bone)
    return bones


def _free_joints(bone: _Bone, joint: int, bones: _Bones) -> int:
    """The number of joints from `joint` to the end of the bone that rotate for it alone."""
    return sum(bones.get(passed) == [bone] for passed in bone[bone.index(joint) : -1])


def _carrier(motion: Motion, hips: int) -> int:
    """The joint whose translation moves the whole body: the hips, or the nearest ancestor whose
    translation differs from its offset. A root at rest stays at rest."""
    for joint in motion.skeleton.path(hips):
        distance = motion.translations[:, joint] - motion.skeleton.offsets[joint]
        if np.abs(distance).max() > _MOVED:
            return joint
    return 0
