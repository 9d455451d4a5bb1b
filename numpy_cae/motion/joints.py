"""The twenty joints of holden2015, section 4, and what other people call them.

The paper uses "the joint positions of 20 of the most important joints" and does not list them.
These are four along the spine and four for each limb. A neck is left out: its place follows from
chest and head, and half of the rigs have two.

A rig is a table from our names to its own. Names are compared without case and without a
prefix up to a colon ("mixamorig:Hips"). Every rig's `chest` is the joint that carries the collars.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton

# joint: (parent, direction of the bone in a T-pose that faces +Z, Y up)
_BODY = {
    "hips": (None, (0.0, 0.0, 0.0)),
    "spine": ("hips", (0.0, 1.0, 0.0)),
    "chest": ("spine", (0.0, 1.0, 0.0)),
    "head": ("chest", (0.0, 1.0, 0.0)),
    "left_collar": ("chest", (0.35, 0.94, 0.0)),
    "left_shoulder": ("left_collar", (1.0, 0.0, 0.0)),
    "left_elbow": ("left_shoulder", (1.0, 0.0, 0.0)),
    "left_wrist": ("left_elbow", (1.0, 0.0, 0.0)),
    "right_collar": ("chest", (-0.35, 0.94, 0.0)),
    "right_shoulder": ("right_collar", (-1.0, 0.0, 0.0)),
    "right_elbow": ("right_shoulder", (-1.0, 0.0, 0.0)),
    "right_wrist": ("right_elbow", (-1.0, 0.0, 0.0)),
    "left_hip": ("hips", (0.77, -0.64, 0.0)),
    "left_knee": ("left_hip", (0.0, -1.0, 0.0)),
    "left_ankle": ("left_knee", (0.0, -1.0, 0.0)),
    "left_toe": ("left_ankle", (0.0, -0.5, 0.87)),
    "right_hip": ("hips", (-0.77, -0.64, 0.0)),
    "right_knee": ("right_hip", (0.0, -1.0, 0.0)),
    "right_ankle": ("right_knee", (0.0, -1.0, 0.0)),
    "right_toe": ("right_ankle", (0.0, -0.5, 0.87)),
}

JOINTS: tuple[str, ...] = tuple(_BODY)
PARENTS: tuple[int, ...] = tuple(
    -1 if parent is None else JOINTS.index(parent) for parent, _ in _BODY.values()
)
REST_DIRECTIONS: np.ndarray = np.array([direction for _, direction in _BODY.values()])

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
    """A skeleton in which some of the twenty joints could not be found."""


def find_joints(skeleton: Skeleton, mapping: dict[str, str] | None = None) -> list[int]:
    """Where in `skeleton` the twenty joints stand, in the order of `JOINTS`.

    Parameters
    ----------
    skeleton : Skeleton
    mapping : dict of our names to the rig's, optional
        Goes before the known rigs; the joints that it leaves out are looked up in the rig that
        fits best.

    Returns
    -------
    list of 20 int

    Raises
    ------
    UnknownRigError
        Listing the joints that are missing and the joints that the rig has.
    """
    place = {_plain(name): index for index, name in enumerate(skeleton.names)}
    best = max(RIGS.values(), key=lambda rig: sum(_plain(name) in place for name in rig.values()))
    wanted = {**best, **(mapping or {})}
    missing = {joint: name for joint, name in wanted.items() if _plain(name) not in place}
    if missing:
        sought = ", ".join(f"{joint} (as {name!r})" for joint, name in missing.items())
        raise UnknownRigError(
            f"the rig has no {sought}; it has {', '.join(skeleton.names)}. "
            "Name its joints in a JSON file of {our name: name in the rig} and pass it as mapping"
        )
    return [place[_plain(wanted[joint])] for joint in JOINTS]


def _plain(name: str) -> str:
    return name.rsplit(":", 1)[-1].strip().lower()


def read_mapping(path: str | Path) -> dict[str, str]:
    """A user's own rig: a JSON object from our joint names to the names in their files.

    Raises
    ------
    UnknownRigError
        If the file is not such an object, naming what is wrong in it.
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

    Raises
    ------
    UnknownRigError
        As `find_joints` does.
    """
    return motion.positions()[:, find_joints(motion.skeleton, mapping)]
