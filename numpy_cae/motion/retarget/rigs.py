"""The names of the twenty joints in common rigs.

A rig is a table from our joint names to its own. Names are compared without case and without a
prefix up to a colon ("mixamorig:Hips"). Every rig's `chest` is the joint that carries the collars.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import problem_of
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton

_LIMBS = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")


def _rig(spine: str, limbs: str, left: str, right: str) -> dict[str, str]:
    """A rig's table; `left` and `right` are patterns such as "Left{}" or "{}_L"."""
    table = dict(zip(("hips", "spine", "chest", "head"), spine.split(), strict=True))
    for side, pattern in (("left", left), ("right", right)):
        for joint, name in zip(_LIMBS, limbs.split(), strict=True):
            table[f"{side}_{joint}"] = pattern.format(name)
    return table


_MOTIONBUILDER_LIMBS = "Shoulder Arm ForeArm Hand UpLeg Leg Foot ToeBase"

RIGS: dict[str, dict[str, str]] = {
    "numpy_cae": {joint: joint for joint in JOINTS},
    "CMU Acclaim": _rig(
        "root upperback thorax head",
        "clavicle humerus radius wrist femur tibia foot toes",
        "l{}",
        "r{}",
    ),
    "Mixamo": _rig("Hips Spine Spine2 Head", _MOTIONBUILDER_LIMBS, "Left{}", "Right{}"),
    "CMU BVH": _rig("Hips Spine Spine1 Head", _MOTIONBUILDER_LIMBS, "Left{}", "Right{}"),
    "Bandai": _rig(
        "Hips Spine Chest Head",
        "Shoulder UpperArm LowerArm Hand UpperLeg LowerLeg Foot Toes",
        "{}_L",
        "{}_R",
    ),
}


class UnknownRigError(NumpyCaeError, ValueError):
    """A skeleton in which some of the twenty joints could not be found, or are no person's."""


def find_joints(skeleton: Skeleton, mapping: dict[str, str] | None = None) -> list[int]:
    """Indices of the twenty joints in a skeleton, in the order of `JOINTS`.

    A mapping of our names to the rig's takes precedence over the known rigs; joints that it omits
    are looked up in the rig that fits best. Raises UnknownRigError, with the joints that are
    missing and the joints that the rig has.
    """
    index = {_plain(name): i for i, name in enumerate(skeleton.names)}
    best = max(RIGS.values(), key=lambda rig: sum(_plain(name) in index for name in rig.values()))
    names = {**best, **(mapping or {})}
    missing = {joint: name for joint, name in names.items() if _plain(name) not in index}
    if missing:
        sought = ", ".join(f"{joint} (as {name!r})" for joint, name in missing.items())
        raise UnknownRigError(
            f"the rig has no {sought}; it has {', '.join(skeleton.names)}. "
            "Name its joints in a JSON file of {our name: name in the rig} and pass it as mapping"
        )
    return [index[_plain(names[joint])] for joint in JOINTS]


def _plain(name: str) -> str:
    return name.rsplit(":", 1)[-1].strip().lower()


def read_mapping(path: str | Path) -> dict[str, str]:
    """A user's own rig: a JSON object of {our joint name: name in the file}.

    Raises UnknownRigError if the file is not such an object, naming what is wrong in it.
    """
    try:
        mapping = json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise UnknownRigError(f"{path}: not JSON: {error}") from None
    if not isinstance(mapping, dict) or not all(isinstance(v, str) for v in mapping.values()):
        raise UnknownRigError(f'{path}: expected an object such as {{"hips": "pelvis", …}}')
    unknown = sorted(set(mapping) - set(JOINTS))
    if unknown:
        raise UnknownRigError(
            f"{path}: not among the twenty joints: {', '.join(unknown)}; "
            f"they are {', '.join(JOINTS)}"
        )
    return mapping


def body_positions(motion: Motion, mapping: dict[str, str] | None = None) -> np.ndarray:
    """World positions of the twenty joints, (frames, 20, 3) in metres.

    Raises UnknownRigError as `find_joints` does, and if the bones are not a person's.
    """
    positions = motion.positions(find_joints(motion.skeleton, mapping))
    problem = problem_of(positions)
    if problem:
        raise UnknownRigError(problem)
    return positions
