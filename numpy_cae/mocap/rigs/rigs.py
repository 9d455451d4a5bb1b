"""Find the twenty joints in a rig by the user's names, the names of known rigs and the hierarchy.

When names are compared, case, blanks, punctuation and a prefix up to a colon ("mixamorig:Hips") do
not matter. In every rig, `chest` is the joint that carries the collars, and `spine` is the joint
nearest to the middle between hips and chest.
"""

import json
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.mocap.rigs.rig_names import RIGS
from numpy_cae.mocap.rigs.suggest import add_trunk, suggest_mapping
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import problem_of
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton

JointNames = dict[str, str]
"""Some of our joint names, each with the joint's name in a rig."""
Mappings = JointNames | Sequence[JointNames] | None
"""One mapping to the names in a rig, or several: each rig then takes the first one that fits."""

_LISTED = 80
"""_LISTED: the largest number of names in a message, as some rigs have hundreds of joints."""
ADDED = " (added)"
"""ADDED: the end of the name of a joint that the file lacks and `completed` added."""


class UnknownRigError(NumpyCaeError, ValueError):
    """Some of the twenty joints were not found in a skeleton, or its bones are not a person's."""


def with_joint_names(skeleton: Skeleton, mapping: Mappings) -> Skeleton:
    """The skeleton with the user's names of the twenty joints.

    A skeleton fits a mapping if it has all names in it. If there are several mappings, the first
    one that fits is used, or none if none fits.
    """
    if not isinstance(mapping, dict):
        index = _finder(skeleton)
        fitting = (names for names in mapping or [] if None not in map(index, names.values()))
        mapping = next(fitting, {})
    return replace(skeleton, joint_names=mapping)


def find_joints(skeleton: Skeleton) -> list[int]:
    """The indices of the twenty joints in a skeleton.

    `Skeleton.joint_names` take precedence over the known rigs. The joints that they omit are looked
    up in the known rig that fits best.

    Parameters
    ----------
    skeleton : Skeleton

    Returns
    -------
    list of 20 int
        In the order of `JOINTS`.

    Raises
    ------
    UnknownRigError
        If joints are missing. The message lists these, the joints that the rig has and a mapping
        that its hierarchy suggests.

    Examples
    --------
    >>> from data_synth import make_take
    >>> skeleton = make_take("walk", 1, seconds=1.0).motion.skeleton
    >>> [skeleton.names[joint] for joint in find_joints(skeleton)[:4]]  # hips, spine, chest, head
    ['root', 'upperback', 'thorax', 'head']
    """
    rig, found = match_rig(skeleton)
    if len(found) == len(JOINTS):
        return [found[joint] for joint in JOINTS]
    names = {joint: RIGS[rig].get(joint, (joint,))[0] for joint in JOINTS} | skeleton.joint_names
    sought = ", ".join(f"{joint} (as {names[joint]!r})" for joint in JOINTS if joint not in found)
    listed = ", ".join([*skeleton.names[:_LISTED], *(["…"] if skeleton.names[_LISTED:] else [])])
    problem = f"the rig has no {sought}; it has {listed}. "
    suggestion = suggest_mapping(skeleton)
    if suggestion:
        problem += f"Its hierarchy suggests {json.dumps(suggestion, ensure_ascii=False)}: "
    problem += "`numpy-cae rig FILE -o mapping.json` writes a mapping to correct and to pass with "
    raise UnknownRigError(problem + "--mapping")


def match_rig(skeleton: Skeleton) -> tuple[str, dict[str, int]]:
    """The known rig that fits best, and the index of each of the twenty joints that was found."""
    named, index = skeleton.joint_names, _finder(skeleton)
    present = {joint: at for joint, name in named.items() if (at := index(name)) is not None}
    plain = _plain_names(skeleton)
    present_in = {
        # The alternatives are reversed, so that the first one that the skeleton has is set last.
        rig: {joint: plain[n] for joint, names in table.items() for n in names[::-1] if n in plain}
        for rig, table in _PLAIN_RIGS.items()
    }
    # The rig with the fewest missing joints; if several are equal, the one with the most found.
    best = min(RIGS, key=lambda rig: (len(RIGS[rig]) - len(present_in[rig]), -len(present_in[rig])))
    found = {joint: at for joint, at in present_in[best].items() if joint not in named} | present
    add_trunk(skeleton, found, set(named))
    for name in skeleton.names[len(skeleton.names) - skeleton.added :]:
        found[name.removesuffix(ADDED)] = skeleton.names.index(name)
    return best, found


def _finder(skeleton: Skeleton) -> Callable[[str], int | None]:
    """A function from a name, exact or plain, to the index of the joint; None if there is none."""
    exact = {name: joint for joint, name in enumerate(skeleton.names)}
    plain = _plain_names(skeleton)
    return lambda name: exact.get(name, plain.get(_plain(name)))


def _plain_names(skeleton: Skeleton) -> dict[str, int]:
    """Plain name -> index of the first joint that has it."""
    return {_plain(name): joint for joint, name in reversed(list(enumerate(skeleton.names)))}


def _plain(name: str) -> str:
    name = name.rsplit(":", 1)[-1].lower()
    return re.sub(r"[\s_.\-]", "", name) or name


_PLAIN_RIGS = {
    rig: {joint: tuple(map(_plain, names)) for joint, names in table.items()}
    for rig, table in RIGS.items()
}


def joint_index(name: str, skeleton: Skeleton) -> int:
    """The index in `JOINTS` of a joint; `name` is our name or the rig's.

    Parameters
    ----------
    name : str
    skeleton : Skeleton

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
    >>> skeleton = make_take("walk", 1, seconds=1.0).motion.skeleton
    >>> JOINTS[joint_index("lfemur", skeleton)]
    'left_hip'
    """
    if name in JOINTS:
        return JOINTS.index(name)
    names_in_rig = [skeleton.names[joint] for joint in find_joints(skeleton)]
    for form in (str, str.lower, _plain):
        if form(name) in (forms := [form(other) for other in names_in_rig]):
            return forms.index(form(name))
    pairs = ", ".join(f"{ours} ({rigs})" for ours, rigs in zip(JOINTS, names_in_rig, strict=True))
    if name in skeleton.names:
        raise UnknownRigError(f"joint {name!r} is not among the twenty, which are {pairs}")
    raise UnknownRigError(f"there is no joint {name!r}; the twenty are {pairs}")


def read_mapping(path: str | Path) -> JointNames:
    """Read a user's names of joints, a JSON object of {our joint name: name in the file}.

    Parameters
    ----------
    path : path of the file

    Returns
    -------
    dict of str to str

    Raises
    ------
    UnknownRigError
        If the file is not such an object; the message says what is wrong.

    Examples
    --------
    >>> _ = Path("rig.json").write_text('{"hips": "pelvis", "head": "skull"}')
    >>> read_mapping("rig.json")
    {'hips': 'pelvis', 'head': 'skull'}
    """
    try:
        mapping = json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise UnknownRigError(f"{path}: not JSON: {error}") from None
    if not isinstance(mapping, dict) or not all(isinstance(v, str) for v in mapping.values()):
        raise UnknownRigError(f'{path}: expected an object such as {{"hips": "pelvis", …}}')
    unknown = sorted(set(mapping) - set(JOINTS))
    if unknown:
        problem = f"not among the twenty joints: {', '.join(unknown)}; they are {', '.join(JOINTS)}"
        raise UnknownRigError(f"{path}: {problem}")
    twice = sorted(name for name, count in Counter(mapping.values()).items() if count > 1)
    if twice:
        problem = f"{', '.join(twice)} stands for several joints; leave out a joint that the rig"
        raise UnknownRigError(f"{path}: {problem} lacks")
    return mapping


def body_positions(motion: Motion) -> np.ndarray:
    """World positions of the twenty joints in each frame of the motion.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    (frames, 20, 3) array of float64
        Metres, at the rate of the motion.

    Raises
    ------
    UnknownRigError
        If joints are missing, or the bones are not a person's.

    Examples
    --------
    >>> from data_synth import make_take
    >>> body_positions(make_take("walk", 1, seconds=2.0, rate=120.0).motion).shape
    (240, 20, 3)
    """
    positions = motion.positions(find_joints(motion.skeleton))
    problem = problem_of(positions)
    if problem:
        raise UnknownRigError(problem)
    return positions
