"""Any rig, made to follow new positions of the twenty joints: how a result gets back into a file.

What a network changes is positions; what a person brought is a rig with fingers, several joints
in its neck, rotations of its own. So the rig's pose is kept and only turned: down the tree, each
joint on the way from one of the twenty to the next adds a turn Q to the global rotation that it
has by then,

    G'_j = Q_j · G'_parent · R_j

that points what hangs from it where it was asked for. One bone turns by the smallest turn, so
that its twist stays; where several leave (hips, chest), one turn fits them all. Joints in between
(a second spine, a neck) share: the i-th of n makes 1 / (n - i) of the turn still needed from its
own place, the last the whole of it, so a long spine bends evenly. No bone changes its length. No
change asked for is no change made, to the bit, and all other joints keep R_j.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import UnknownRigError, find_joints
from numpy_cae.motion.retarget.rotations import fan, swing
from numpy_cae.motion.skeleton import Skeleton

_TURNED = 1e-9
"""Radians, and metres at a bone's end. Less is rounding, and a rotation stays as it came."""
_MOVED = 1e-6
"""Metres. A joint further from its offset than this carries the body through the world."""

_MENDED = 0.3
"""How much a bone with joints in between counts in a fan: those can still point it right, while
the hips sit where the pelvis has them. Alone it turns no fan."""

_HOLD = 0.03
"""τ of `fan`. CMU's collars begin at one point, so all bones of its chest lie nearly along one
line, and about it an error of a centimetre would turn the chest by a right angle. More, and turns
that were asked for are held back (lessons/papers_to_code.md)."""


@dataclass(frozen=True)
class _Bone:
    """The way along the rig from one of the twenty joints to the next, as indices of the rig."""

    start: int
    between: tuple[int, ...]
    end: int


def retarget(
    motion: Motion, positions: np.ndarray, mapping: dict[str, str] | None = None
) -> Motion:
    """The motion, changed as little as makes its twenty joints follow new positions.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found.
    positions : (F, 20, 3) array of float
        Asked-for world positions in metres, one for each frame of the motion at its own rate
        (`body.at_rate_of` makes them of positions at 30 frames a second).
    mapping : dict of our joint names to the rig's, optional

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length. The hips are where they were asked for;
        other joints as near as bones that keep their length allow.

    Raises
    ------
    ValueError
        If the positions are not finite or their shape does not fit the motion.
    UnknownRigError
        If joints are missing, or one of the twenty hangs from none of the others.
    """
    joints = find_joints(motion.skeleton, mapping)
    if np.shape(positions) != (len(motion), len(JOINTS), 3):
        raise ValueError(
            f"positions have shape {np.shape(positions)}, expected ({len(motion)}, 20, 3): one "
            "pose of the twenty joints for each frame of the motion"
        )
    if not np.all(np.isfinite(positions)):
        raise ValueError("positions hold values that are not finite")
    asked = {joint: positions[:, place] for place, joint in enumerate(joints)}
    before, turned_before = motion.forward_kinematics()
    through = _bones_through(motion, joints)
    rotations = motion.rotations.copy()
    translations = _moved(motion, joints[0], asked[joints[0]] - before[:, joints[0]])

    now = np.empty(before.shape)
    turned: list[Rotation] = []
    for joint, parent in enumerate(motion.skeleton.parents):
        above = turned[parent] if parent >= 0 else Rotation.identity(len(motion))
        here = above * Rotation.from_quat(motion.rotations[:, joint])
        now[:, joint] = above.apply(translations[:, joint])
        if parent >= 0:
            now[:, joint] += now[:, parent]
        if joint in through:
            bones = through[joint]
            since = here * turned_before[joint].inv()
            seen = np.stack([since.apply(before[:, b.end] - before[:, joint]) for b in bones], 1)
            wanted = np.stack([asked[bone.end] - now[:, joint] for bone in bones], axis=1)
            if len(bones) == 1:
                turn = swing(seen[:, 0], wanted[:, 0], 1 / _turns_left(bones[0], joint, through))
                turns = turn.magnitude() > _TURNED
            else:
                mended = np.array([_turns_left(bone, joint, through) > 0 for bone in bones])
                turn = fan(seen * np.where(mended, _MENDED, 1.0)[:, None], wanted, _HOLD)
                decides = ~mended | mended.all()
                misses = np.linalg.norm(wanted - seen, axis=-1) > _TURNED
                turns = misses[:, decides].any(axis=1) & (turn.magnitude() > _TURNED)
                # Asked to stay, the fan turns back exactly, where a fit would be near.
                were = np.stack([before[:, b.end] - before[:, joint] for b in bones], axis=1)
                stay = np.abs(wanted - were).max(axis=(1, 2)) < _TURNED
                turn = _either(stay, turned_before[joint] * here.inv(), turn)
            if turns.any():
                here = _either(turns, turn * here, here)
                rotations[turns, joint] = (above.inv() * here).as_quat()[turns]
        turned.append(here)
    return replace(motion, rotations=rotations, translations=translations)


def _either(chosen: np.ndarray, one: Rotation, other: Rotation) -> Rotation:
    """Frame by frame, `one` where it is chosen, else `other`."""
    return Rotation.from_quat(np.where(chosen[:, None], one.as_quat(), other.as_quat()))


def moves_alone(motion: Motion, joint: str, mapping: dict[str, str] | None = None) -> bool:
    """Whether a joint of the twenty can move while all the others stay where they are.

    It can where something in the rig turns for its bone alone and no more than one bone goes on
    from it. A collar or a hip that sits on its fan, and the hips and the chest themselves, cannot.
    """
    through = _bones_through(motion, find_joints(motion.skeleton, mapping))
    place = find_joints(motion.skeleton, mapping)[JOINTS.index(joint)]
    onward = [bone for bone in through.get(place, []) if bone.start == place]
    arriving = {bone for bones in through.values() for bone in bones if bone.end == place}
    return len(onward) < 2 and any(_turns_left(bone, bone.start, through) for bone in arriving)


def _bones_through(motion: Motion, joints: list[int]) -> dict[int, list[_Bone]]:
    """For each joint of the rig that is to turn, the bones that begin at it or run through it."""
    through: dict[int, list[_Bone]] = {}
    for place, joint in enumerate(joints[1:], start=1):
        bone = _bone_to(motion.skeleton, joint, joints, JOINTS[place])
        for on_it in (bone.start, *bone.between):
            # A joint in between that never turns (CMU's lhipjoint) is part of a stiff bone.
            if on_it == bone.start or not _is_stiff(motion, on_it):
                through.setdefault(on_it, []).append(bone)
    return through


def _bone_to(skeleton: Skeleton, joint: int, joints: list[int], name: str) -> _Bone:
    between: list[int] = []
    above = skeleton.parents[joint]
    while above not in joints:
        if above < 0:
            raise UnknownRigError(
                f"{name} ({skeleton.names[joint]!r} in the rig) hangs from none of the twenty "
                "joints: is another joint of the rig its hips? Name it in a mapping"
            )
        between.insert(0, above)
        above = skeleton.parents[above]
    return _Bone(above, tuple(between), joint)


def _is_stiff(motion: Motion, joint: int) -> bool:
    return bool(np.abs(motion.rotations[:, joint, :3]).max() < _TURNED)


def _turns_left(bone: _Bone, joint: int, through: dict[int, list[_Bone]]) -> int:
    """How many joints on a bone, from this one on, turn for it alone."""
    way = (bone.start, *bone.between)
    return sum(through.get(on_it) == [bone] for on_it in way[way.index(joint) :])


def _moved(motion: Motion, hips: int, step: np.ndarray) -> np.ndarray:
    """Translations that move the hips by `step` (F, 3) in the world.

    The joint that moves is the one that carries the body through the world in this file: the hips
    or the nearest joint above them that leaves its offset. A root below that stays at rest.
    """
    carrier = hips
    while carrier > 0 and not _leaves_its_offset(motion, carrier):
        carrier = motion.skeleton.parents[carrier]
    translations = motion.translations.copy()
    if carrier > 0:
        _, turned = motion.forward_kinematics()
        step = turned[motion.skeleton.parents[carrier]].inv().apply(step)
    translations[:, carrier] += step
    return translations


def _leaves_its_offset(motion: Motion, joint: int) -> bool:
    away = motion.translations[:, joint] - motion.skeleton.offsets[joint]
    return bool(np.abs(away).max() > _MOVED)
