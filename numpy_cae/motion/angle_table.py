"""The 54 numbers of a frame, by name: jang2018 represents motion "in joint space, whose dimension
is 54 made by 17 joints".

17 joints of three numbers each are 51; the root's translation makes 54. Which 17 the poster does
not say; these are the seventeen that papers on Human3.6M draw, five along the trunk and three for
each limb. They turn; collars and toes are carried along, so that all twenty `JOINTS` can be drawn.

Of the text of Human3.6M itself MBR17 drops the constant columns, which also leaves 54: 21 joints,
of which six (knees, elbows, toes) only bend about x. That is the second table.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from numpy_cae.motion.io.expmap_rigs import HUMAN36M
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.retarget.rigs import find_joints
from numpy_cae.motion.skeleton import Skeleton

TRANSLATION = slice(0, 3)
"""The root's translation, metres, relative to the first frame of a clip. Then come the angles."""
ANGLES = slice(3, 54)
"""Rotation vectors (exponential maps) in radians."""


@dataclass(frozen=True)
class AngleTable:
    """What each of the 54 numbers is.

    Parameters
    ----------
    name : str
    joints : tuple of J str
        Joints that are drawn, a parent before its children, the root first.
    parents : tuple of J int
    turning : tuple of (joint, its axes)
        Joints that turn, in the order of the numbers, such as ("hips", "xyz").
    """

    name: str
    joints: tuple[str, ...]
    parents: tuple[int, ...]
    turning: tuple[tuple[str, str], ...]

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """A name for each of the 54 numbers: "translation x", …, "hips x", …"""
        moved = [f"translation {axis}" for axis in "xyz"]
        return (*moved, *(f"{joint} {axis}" for joint, axes in self.turning for axis in axes))

    @cached_property
    def places(self) -> np.ndarray:
        """Where the 51 angles stand among the 3J numbers of all joints that are drawn."""
        return np.array(
            [
                3 * self.joints.index(joint) + "xyz".index(axis)
                for joint, axes in self.turning
                for axis in axes
            ]
        )

    @cached_property
    def carriers(self) -> tuple[int, ...]:
        """For each joint the nearest one above it that turns, -1 for the root."""
        turning = {joint for joint, _ in self.turning}
        above = []
        for parent in self.parents:
            while parent >= 0 and self.joints[parent] not in turning:
                parent = self.parents[parent]
            above.append(parent)
        return tuple(above)

    def locate(self, skeleton: Skeleton, mapping: dict[str, str] | None = None) -> list[int]:
        """Where in a skeleton the joints stand.

        Raises
        ------
        UnknownRigError
            If joints are missing.
        """
        if self is HUMAN36M_TABLE:
            return [skeleton.index(joint) for joint in self.joints]
        found = dict(zip(JOINTS, find_joints(skeleton, mapping), strict=True))
        found["neck"] = _below_chest(skeleton, found["chest"], found["head"])
        return [found[joint] for joint in self.joints]


def _below_chest(skeleton: Skeleton, chest: int, head: int) -> int:
    """The neck, whatever it is called: the first joint on the way from the chest to the head (the
    head itself in rigs without one; their neck then turns for both and the head not at all)."""
    joint = head
    while skeleton.parents[joint] not in (chest, -1):
        joint = skeleton.parents[joint]
    return joint


_TRUNK = ("hips", "spine", "chest", "neck", "head")
_LIMBS = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
_NAMES = (*JOINTS[: JOINTS.index("head")], "neck", *JOINTS[JOINTS.index("head") :])


def _above(joint: str) -> int:
    if joint in ("neck", "head"):
        return _NAMES.index("chest" if joint == "neck" else "neck")
    parent = PARENTS[JOINTS.index(joint)]
    return -1 if parent < 0 else _NAMES.index(JOINTS[parent])


SEVENTEEN = AngleTable(
    "seventeen joints",
    _NAMES,
    tuple(_above(joint) for joint in _NAMES),
    tuple(
        (joint, "xyz")
        for joint in (*_TRUNK, *(f"{side}_{limb}" for side in ("left", "right") for limb in _LIMBS))
    ),
)

_BENDING = ("RightLeg", "RightToeBase", "LeftLeg", "LeftToeBase", "LeftForeArm", "RightForeArm")
_VARYING = (
    "Hips",
    *("RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"),
    *("LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"),
    *("Spine", "Spine1", "Neck", "Head"),
    *("LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"),
    *("RightShoulder", "RightArm", "RightForeArm", "RightHand"),
)


def _varying_parent(joint: str) -> int:
    skeleton = HUMAN36M.skeleton
    parent = skeleton.parents[skeleton.index(joint)]
    return -1 if parent < 0 else _VARYING.index(skeleton.names[parent])


HUMAN36M_TABLE = AngleTable(
    "the columns of Human3.6M that vary",
    _VARYING,
    tuple(_varying_parent(joint) for joint in _VARYING),
    tuple((joint, "x" if joint in _BENDING else "xyz") for joint in _VARYING),
)

TABLES = {table.name: table for table in (SEVENTEEN, HUMAN36M_TABLE)}


def table_for(skeleton: Skeleton) -> AngleTable:
    """Human3.6M's own table for its text, the seventeen joints for every other rig."""
    return HUMAN36M_TABLE if skeleton.names == HUMAN36M.skeleton.names else SEVENTEEN
