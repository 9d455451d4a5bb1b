"""Recognise the twenty joints in the rig of a file: by names, by hierarchy, or not at all.

The names of common rigs come first. If they leave joints open, the hierarchy suggests these, or
all. A suggestion is used and noted if its joints are in order along each limb, names and places
agree on left and right, and the bones and the pose are a person's. A doubtful one is only noted,
and `rig_of` then refuses the motion. Doubts about a rig that names determine are noted, too.

Those of the twenty joints that a rig lacks are added, if their positions are known. In many rigs a
leg ends at the ankle, with the toes as its End Site, or one bone connects the hips with the chest
or the chest with a shoulder. The joint that is added is a point fixed to a bone of the rig. Added
joints are never written to a file. A rig may also end at ankles or chest without an End Site. Then
toes are added in front of the ankle and a head above the chest, at a person's distance, as points
fixed to ankle and chest.
"""

import json
from dataclasses import replace

import numpy as np

from numpy_cae.mocap.rigs import rigs
from numpy_cae.mocap.rigs.rigs import JointNames, Mappings, Rig, RiggedMotion, UnknownRigError
from numpy_cae.mocap.rigs.suggest import suggest_mapping
from numpy_cae.motion import JOINTS, PARENTS, Motion, Note, Skeleton
from numpy_cae.motion.features import frame_lengths
from numpy_cae.motion.fit import unit_vectors
from numpy_cae.motion.quaternions import IDENTITY, inverse, rotate

_POSES = 100
"""About this many poses of a motion are looked at."""
_LISTED = 12
"""A message lists at most this many names of joints, as some rigs have hundreds."""
_FEW = 4
"""A note lists the joints that the hierarchy gave if they are fewer than this."""


MIRRORED = "the toes point backwards: are left and right exchanged, or is the file a mirror image?"
"""The note on a rig of a known person whose left side is to the right of where the toes point."""

NOT_UPRIGHT = "neither the rest pose nor most others are upright"
"""The doubt about a rig, such as an animal's, of which no pose is a standing person's."""


def recognise_rig(motion: Motion, mapping: Mappings = None) -> RiggedMotion:
    """The motion with its rig, and with those of the twenty joints added that the rig lacks.

    Parameters
    ----------
    motion : Motion
    mapping : dict of joint name to the rig's joint name, or several, optional
        The user's, as in `load_motion`; they are not changed.

    Returns
    -------
    RiggedMotion
        If names alone do not determine the joints, a note says what was done about it.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = recognise_rig(make_take("walk", 1, seconds=1.0, rate=30.0).motion)
    >>> walk.rig.name, walk.skeleton.names[walk.rig.indices["left_hip"]]
    ('CMU Acclaim', 'lfemur')
    """
    by_names = rigs.attach_rig(motion, rigs.rig_by_names(motion.skeleton, mapping))
    completed = add_missing_joints(by_names, estimate=mapping is not None)
    if not find_order_problem(completed):
        # An animal's rig may have a person's names.
        at = _joints_at(completed)
        doubt = "" if mapping else _find_doubt_in_poses(completed, at)
        if doubt == NOT_UPRIGHT and _has_spine_at_hips(by_names):
            return _add_note(by_names, f"rig not recognised: {doubt}", in_doubt=True)
        if doubt:
            return _add_note(completed, f"is this a person? {doubt}", in_doubt=True)
        if _is_mirrored(completed, at):
            return _add_note(completed, MIRRORED, in_doubt=True)
        return completed
    names = {joint: motion.skeleton.names[at] for joint, at in by_names.rig.indices.items()}
    proposed, doubt = _propose_rig(by_names, names)
    if proposed is not None and not doubt:
        return _add_note(proposed, _describe_ways(proposed, names))
    estimated = add_missing_joints(by_names, estimate=True)
    if not find_order_problem(estimated):
        ways = _describe_ways(estimated, names)
        text = f"is this a person? {find_doubt(estimated)}; {ways}"
        return _add_note(estimated, text, in_doubt=True)
    if proposed is not None and len(completed.rig.indices) < len(JOINTS):
        return _add_note(completed, f"rig not recognised: {doubt}", in_doubt=True)
    return completed


def _has_spine_at_hips(motion: RiggedMotion) -> bool:
    """Whether a rig has no spine but joints at the place of the hips that carry the chest."""
    indices = motion.rig.indices
    if "spine" in indices or "chest" not in indices:
        return False
    return motion.skeleton.parents[indices["chest"]] != indices["hips"]


def _propose_rig(by_names: RiggedMotion, names: JointNames) -> tuple[RiggedMotion | None, str]:
    """The motion with the first rig that the hierarchy suggests without a doubt, or else with the
    last one that it suggests, and the doubt about that; None if it suggests nothing.

    `names` are the joints' names in the rig `by_names`; they are tried together with the
    suggestion.
    """
    skeleton = by_names.skeleton
    # Where a joint has position channels, its offset may be wrong: the median in the motion is not.
    offsets = np.median(by_names.sampled(_POSES).translations, axis=0)
    suggested = suggest_mapping(replace(skeleton, offsets=offsets))
    proposed = None
    doubt = ""
    for candidate in (suggested | names, names, suggested):
        if not candidate:
            continue
        rig = rigs.rig_by_names(skeleton, candidate | by_names.rig.mapping)
        proposed = add_missing_joints(rigs.attach_rig(by_names, rig), estimate=True)
        doubt = find_doubt(proposed)
        if not doubt:
            break
    return proposed, doubt


def _add_note(motion: RiggedMotion, text: str, in_doubt: bool = False) -> RiggedMotion:
    """The motion with a note on its rig."""
    return replace(motion, notes=(*motion.notes, Note("rig", text, in_doubt)))


def _describe_ways(motion: RiggedMotion, names: JointNames) -> str:
    """How the joints were found, for a person; `names` are those that a common rig's names gave."""
    rig = motion.rig
    by_hierarchy = [joint for joint, name in rig.mapping.items() if names.get(joint) != name]
    added = [joint for joint in JOINTS if rig.indices[joint] in rig.added]
    ways = []
    if len(by_hierarchy) >= _FEW:
        ways.append(f"{len(by_hierarchy)} joints found by the hierarchy")
    elif by_hierarchy:
        ways.append(f"{', '.join(by_hierarchy)} found by the hierarchy")
    if added:
        ways.append(f"{', '.join(added)} added")
    return f"{' and '.join(ways)}: `numpy-cae rig` lists the joints"


def rig_of(motion: Motion) -> Rig:
    """The rig of a motion: found when its file was loaded, or else by the names of its joints.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    Rig
        Its `joints` are the indices of the twenty joints.

    Raises
    ------
    UnknownRigError
        If joints are missing. The message lists these, the joints that the rig has and a mapping
        that its hierarchy suggests.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 1, seconds=1.0).motion
    >>> [walk.skeleton.names[joint] for joint in rig_of(walk).joints[:4]]
    ['root', 'upperback', 'thorax', 'head']
    """
    return _require_all(rigs.partial_rig_of(motion), motion.skeleton)


def find_joints(skeleton: Skeleton) -> list[int]:
    """The indices of the twenty joints in a skeleton, by the names of its joints.

    Parameters
    ----------
    skeleton : Skeleton

    Returns
    -------
    list of 20 int
        In the order of `JOINTS`. For a motion that was loaded use `rig_of`, which also knows joints
        that were found by a mapping or by the hierarchy.

    Raises
    ------
    UnknownRigError
        As `rig_of`.

    Examples
    --------
    >>> from data_synth import make_take
    >>> skeleton = make_take("walk", 1, seconds=1.0).motion.skeleton
    >>> [skeleton.names[joint] for joint in find_joints(skeleton)[:4]]  # hips, spine, chest, head
    ['root', 'upperback', 'thorax', 'head']
    """
    return _require_all(rigs.rig_by_names(skeleton), skeleton).joints


def _require_all(rig: Rig, skeleton: Skeleton) -> Rig:
    """The rig; UnknownRigError if one of the twenty joints is missing."""
    if len(rig.indices) == len(JOINTS):
        return rig
    usual_names = {joint: rigs.RIGS[rig.name].get(joint, (joint,))[0] for joint in JOINTS}
    names = usual_names | rig.mapping
    missing = [joint for joint in JOINTS if joint not in rig.indices]
    sought = "no " + ", ".join(f"{joint} (as {names[joint]!r})" for joint in missing)
    if len(missing) == len(JOINTS):
        sought = "none of the twenty joints by name"
    listed = list(skeleton.names[:_LISTED])
    if len(skeleton.names) > _LISTED:
        listed.append("…")
    problem = f"the rig has {sought}; it has {', '.join(listed)}. "
    suggestion = suggest_mapping(skeleton)
    if suggestion:
        problem += f"Its hierarchy suggests {json.dumps(suggestion, ensure_ascii=False)}: "
    problem += "`numpy-cae rig FILE -o mapping.json` writes a mapping to correct and to pass with "
    raise UnknownRigError(problem + "--mapping")


def joint_index(name: str, motion: Motion) -> int:
    """The index in `JOINTS` of a joint; `name` is our name or the rig's.

    Parameters
    ----------
    name : str
    motion : Motion

    Returns
    -------
    int

    Raises
    ------
    UnknownRigError
        If there is no such joint, or the rig's joint of this name is not among the twenty.

    Examples
    --------
    >>> from data_synth import make_take
    >>> JOINTS[joint_index("lfemur", make_take("walk", 1, seconds=1.0).motion)]
    'left_hip'
    """
    if name in JOINTS:
        return JOINTS.index(name)
    rig_names = [motion.skeleton.names[joint] for joint in rig_of(motion).joints]
    for form in (str, str.lower, rigs.plain_name):
        forms = [form(rig_name) for rig_name in rig_names]
        if form(name) in forms:
            return forms.index(form(name))
    names = zip(JOINTS, rig_names, strict=True)
    pairs = ", ".join(f"{our_name} ({rig_name})" for our_name, rig_name in names)
    if name in motion.skeleton.names:
        raise UnknownRigError(f"joint {name!r} is not among the twenty, which are {pairs}")
    raise UnknownRigError(f"there is no joint {name!r}; the twenty are {pairs}")


UNEQUAL_RATIO = 1.5
"""The bones of a left and a right limb differ by at most this factor. A program that estimates a
pose from one video frame gives them different lengths."""
LEG_COSINE = 0.5
"""Where a person stands, the direction from the hips to the ankles and that from the chest to the
hips have at least this cosine."""
RATIOS = {
    "thigh to shin": ("knee", "ankle", 0.6, 1.7),
    "upper arm to forearm": ("elbow", "wrist", 0.6, 2.2),
    "thigh to upper arm": ("knee", "elbow", 1.0, 2.3),
    "shin to forearm": ("ankle", "wrist", 1.0, 2.8),
    "trunk to thigh": ("trunk", "knee", 0.3, 1.8),
}
"""The smallest and largest ratio of the lengths of two bones, which are named by the joints where
they end; the trunk ends at the chest and begins at the hips. In the files of five sources the
ratios are 0.9 to 1.3, 1.0 to 1.7, 1.4 to 1.7, 1.5 to 2.1 and 0.5 to 0.8."""


def find_order_problem(motion: RiggedMotion) -> str:
    """Which of the twenty joints were not found, or does not descend from its parent in the rig, or
    from the next one if the file lacks the parent; empty if all do."""
    joints = motion.rig.joints
    if len(set(joints)) < len(JOINTS):
        return f"only {len(set(joints))} of the 20 joints were found"
    for joint, parent in enumerate(PARENTS[1:], start=1):
        while joints[parent] in motion.rig.added:
            parent = PARENTS[parent]
        if joints[parent] not in motion.skeleton.path(joints[joint])[1:]:
            return f"{JOINTS[joint]} is not below {JOINTS[parent]}"
    return ""


def find_doubt(motion: RiggedMotion) -> str:
    """Why a rig's twenty joints may not be these; empty if there is no reason."""
    return find_order_problem(motion) or _find_doubt_in_poses(motion, _joints_at(motion))


def _find_doubt_in_poses(motion: RiggedMotion, at: dict[str, np.ndarray]) -> str:
    """Why the twenty joints may not be these, from their positions (N, 3) by joint."""
    body = np.stack([at[joint] for joint in JOINTS], axis=1)
    problem = _find_side_problem(motion, at)
    if not problem:
        problem = _find_length_problem(at, np.median(frame_lengths(body), axis=0))
    if not problem and not _is_usual(_stands(at)):
        problem = NOT_UPRIGHT
    return problem


def _joints_at(motion: RiggedMotion) -> dict[str, np.ndarray]:
    """The positions (N, 3) of the twenty joints by name, first in the rest pose."""
    poses = motion.sampled(_POSES)
    rest = replace(motion.skeleton, offsets=np.median(poses.translations, axis=0))
    joints = motion.rig.joints
    body = np.concatenate([rest.rest_positions()[None, joints], poses.positions(joints)])
    return {joint: body[:, index] for index, joint in enumerate(JOINTS)}


def _is_usual(in_pose: np.ndarray) -> bool:
    """Whether something is so in the rest pose, which is the first one, or in most other poses."""
    return bool(in_pose[0] or np.mean(in_pose[1:]) > 0.5)


def _find_side_problem(motion: RiggedMotion, at: dict[str, np.ndarray]) -> str:
    """Why left and right may be exchanged, from the joints' names and positions (N, 3) by joint."""
    across = at["left_hip"] - at["right_hip"]
    shoulders = at["left_shoulder"] - at["right_shoulder"]
    if not _is_usual(np.sum(across * shoulders, axis=-1) > 0):
        return "an arm and a leg of one side are on different sides"
    indices = motion.rig.indices
    names = {joint: motion.skeleton.names[index] for joint, index in indices.items()}
    sides = []
    for joint in JOINTS:
        if not joint.startswith("left") or indices[joint] in motion.rig.added:
            continue
        side = rigs.left_or_right(names[joint], names[joint.replace("left", "right")])
        if side == "right":
            return f"{names[joint]} does not sound like the left side"
        sides.append(side)
    if "" not in sides:
        return ""
    if indices["left_toe"] in motion.rig.added:
        return "neither names nor toes tell left from right"
    return "" if _is_usual(_toes_point_forward(at)) else "the toes point backwards"


def _toes_point_forward(at: dict[str, np.ndarray]) -> np.ndarray:
    """Whether the left side is to the left of where the toes point, (N,)."""
    across = at["left_hip"] - at["right_hip"]
    forward = at["left_toe"] - at["left_ankle"] + at["right_toe"] - at["right_ankle"]
    left = np.cross(at["chest"] - at["hips"], forward)
    return np.asarray(np.sum(left * across, axis=-1) > 0)


def _is_mirrored(motion: RiggedMotion, at: dict[str, np.ndarray]) -> bool:
    """Whether the toes point backwards in the rest pose and in most others: then left and right of
    the joints' names are exchanged, or the file is a mirror image. False if toes were added."""
    indices = motion.rig.indices
    if {indices["left_toe"], indices["right_toe"]} & set(motion.rig.added):
        return False
    return not _is_usual(_toes_point_forward(at))


def _find_length_problem(at: dict[str, np.ndarray], lengths: np.ndarray) -> str:
    """Which bones, of these lengths (20,), are not as long as a person's beside others."""
    length = dict(zip(JOINTS, lengths.tolist(), strict=True))
    trunk = np.linalg.norm(at["chest"] - at["hips"], axis=-1)
    mean = {"trunk": float(np.median(trunk))}
    for joint in ("elbow", "wrist", "knee", "ankle"):
        left = length[f"left_{joint}"]
        right = length[f"right_{joint}"]
        if not max(left, right) <= UNEQUAL_RATIO * min(left, right):
            return f"the bones to left_{joint} and right_{joint} are not equally long"
        mean[joint] = (left + right) / 2
    for bones, (first, second, least, most) in RATIOS.items():
        ratio = mean[first] / max(mean[second], 1e-9)
        if not least <= ratio <= most:
            return f"the ratio of {bones} is {ratio:.2g}, a person's is {least:g} to {most:g}"
    return ""


def _stands(at: dict[str, np.ndarray]) -> np.ndarray:
    """Whether, along the line from hips to chest, the ankles are below the hips and the head is
    above the chest, (N,). An animal's hind legs are square to that line in every pose."""
    trunk = at["chest"] - at["hips"]
    ankles = (at["left_ankle"] + at["right_ankle"]) / 2 - at["hips"]
    head = at["head"] - at["chest"]
    straight = -LEG_COSINE * np.linalg.norm(ankles, axis=-1) * np.linalg.norm(trunk, axis=-1)
    return (np.sum(ankles * trunk, axis=-1) < straight) & (np.sum(head * trunk, axis=-1) > 0)


_BETWEEN = {
    "spine": ("chest", 0.5),
    "left_collar": ("left_shoulder", 0.3),
    "right_collar": ("right_shoulder", 0.3),
}
"""Missing joint -> (the joint where its bone ends, how far along the bone it is added, 0 to 1). The
shares are those of CMU's rig."""


_TOE = 0.33
_HEAD = 0.6
"""The distance from the ankle to an added toe in shins, and from the chest to an added head in
thighs; in the files of five sources they are 0.23 to 0.5 and 0.45 to 0.75."""
_SHORT_SHARE = 0.1
"""An End Site nearer to the ankle than this part of the shin is no toe."""


def add_missing_joints(motion: RiggedMotion, estimate: bool = False) -> RiggedMotion:
    """The motion with the missing ones of the twenty joints added after its own joints.

    The same motion if the position of a missing joint is not known. If `estimate`, toes and a head
    without an End Site are added at a person's distance.
    """
    rig = motion.rig
    missing = [joint for joint in JOINTS if joint not in rig.indices]
    if not missing:
        return motion
    parents = []
    offsets = []
    for joint in missing:
        parent = rig.indices.get(JOINTS[PARENTS[JOINTS.index(joint)]])
        if parent is None:
            return motion
        parent = _carrier_of(motion, joint, parent)
        offset = _offset(motion, joint, parent, estimate)
        if not offset.any():
            return motion
        parents.append(parent)
        offsets.append(offset)
    skeleton = motion.skeleton
    extended = replace(
        skeleton,
        names=(*skeleton.names, *(f"{joint} (added)" for joint in missing)),
        parents=(*skeleton.parents, *parents),
        offsets=np.concatenate([skeleton.offsets, offsets]),
    )
    added = range(len(skeleton.names), len(extended.names))
    still = np.tile(IDENTITY, (len(motion), len(missing), 1))
    places = np.tile(offsets, (len(motion), 1, 1))
    indices = rig.indices | dict(zip(missing, added, strict=True))
    return replace(
        motion,
        skeleton=extended,
        rotations=np.concatenate([motion.rotations, still], axis=1),
        translations=np.concatenate([motion.translations, places], axis=1),
        rig=replace(rig, indices=indices, added=tuple(added)),
    )


def _carrier_of(motion: RiggedMotion, joint: str, parent: int) -> int:
    """The joint of the rig to which a missing one is added: the parent, or a joint at the same
    place that carries the joint where the missing one's bone ends."""
    end, _ = _BETWEEN.get(joint, ("", 0.0))
    if end not in motion.rig.indices:
        return parent
    skeleton = motion.skeleton
    path = skeleton.path(motion.rig.indices[end])[1:]
    if parent not in path or skeleton.offsets[path[: path.index(parent)]].any():
        return parent
    return path[0]


def _offset(motion: RiggedMotion, joint: str, parent: int, estimate: bool) -> np.ndarray:
    """The offset of a missing joint from its parent in the rig; zero if it is not known."""
    end, part = _BETWEEN.get(joint, ("", 0.0))
    end_joint = motion.rig.indices.get(end, 0)
    if end and motion.skeleton.parents[end_joint] == parent:
        return part * np.nanmean(motion.translations[:, end_joint], axis=0)
    if JOINTS.index(joint) in PARENTS:
        return np.zeros(3)
    end_site = motion.skeleton.end_sites.get(parent, np.zeros(3))
    is_estimated = estimate and not joint.endswith("wrist")
    return _estimate_offset(motion, joint, parent, end_site) if is_estimated else end_site


def _estimate_offset(
    motion: RiggedMotion, joint: str, parent: int, end_site: np.ndarray
) -> np.ndarray:
    """The offset of a toe from the ankle or the head from the chest: that of its End Site, or if it
    is too short or missing, the median of some poses; zero if the joints around it are missing."""
    side = "left" if joint == "head" else joint.removesuffix("_toe")
    around = ("hips", "chest", "left_hip", "right_hip", f"{side}_knee", f"{side}_ankle")
    if not set(around) <= set(motion.rig.indices):
        return np.zeros(3)
    positions, rotations = motion.sampled(_POSES).forward_kinematics()
    joints = [motion.rig.indices[name] for name in around]
    hips, chest, left, right, knee, ankle = positions[:, joints].swapaxes(0, 1)
    if joint == "head":
        distance = _HEAD * np.linalg.norm(knee - left, axis=-1, keepdims=True)
        along = unit_vectors(chest - hips)
    else:
        shin = ankle - knee
        distance = _TOE * np.linalg.norm(shin, axis=-1, keepdims=True)
        forward = np.cross(left - right, -shin)
        along = 0.87 * unit_vectors(forward) + 0.5 * unit_vectors(shin)  # as in `REST_DIRECTIONS`
        if np.linalg.norm(end_site) > _SHORT_SHARE / _TOE * np.median(distance):
            return end_site
    return np.median(rotate(inverse(rotations[:, parent]), distance * along), axis=0)
