"""The 54 numbers of a frame, by name: jang2018 represents motion "in joint space, whose dimension
is 54 made by 17 joints".

17 joints of three numbers each are 51; the root's translation makes 54. The poster does not list
the joints; these are the seventeen that papers on Human3.6M draw, five along the trunk and three
for each limb. Collars and toes do not rotate, but are included so that all `JOINTS` can be drawn.

MBR17 drops the constant columns of Human3.6M's own text, which also leaves 54 numbers: 21 joints
rotate, six of them (knees, elbows, toes) about x only. That is the second table.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from numpy_cae.motion.expmap_rigs import HUMAN36M
from numpy_cae.motion.joints import JOINTS, PARENTS

TRANSLATION = slice(0, 3)
"""The root's translation, metres, relative to the first frame of a clip. Then come the angles."""
ANGLES = slice(3, 54)
"""Rotation vectors (exponential maps) in radians."""


@dataclass(frozen=True)
class AngleTable:
    """The meaning of the 54 numbers.

    Parameters
    ----------
    name : str
    joints : tuple of J str
        Joints that are drawn, parents before children, the root first.
    parents : tuple of J int
    rotating : tuple of (joint, its axes)
        Joints that rotate, in the order of the numbers, such as ("hips", "xyz").
    """

    name: str
    joints: tuple[str, ...]
    parents: tuple[int, ...]
    rotating: tuple[tuple[str, str], ...]

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """A name for each of the 54 numbers: "translation x", …, "hips x", …"""
        named = (("translation", "xyz"), *self.rotating)
        return tuple(f"{joint} {axis}" for joint, axes in named for axis in axes)

    @cached_property
    def indices(self) -> np.ndarray:
        """The indices of the 51 angles among the 3J numbers of all joints."""
        starts = [(3 * self.joints.index(joint), axes) for joint, axes in self.rotating]
        return np.array([start + "xyz".index(axis) for start, axes in starts for axis in axes])

    @cached_property
    def rotating_parents(self) -> tuple[int, ...]:
        """For each joint the nearest ancestor that rotates, -1 for the root."""
        rotating = {joint for joint, _ in self.rotating}
        nearest = []
        for parent in self.parents:
            while parent >= 0 and self.joints[parent] not in rotating:
                parent = self.parents[parent]
            nearest.append(parent)
        return tuple(nearest)


def _table(name: str, parent_of: dict[str, str | None], rotating: dict[str, str]) -> AngleTable:
    """The table of the joints in `parent_of`; those in `rotating` rotate about the axes there."""
    joints = tuple(parent_of)
    parents = tuple(-1 if joint is None else joints.index(joint) for joint in parent_of.values())
    return AngleTable(name, joints, parents, tuple(rotating.items()))


_LIMBS = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
_PARENT_OF: dict[str, str | None] = {}
for _joint, _parent in zip(JOINTS, (None, *(JOINTS[place] for place in PARENTS[1:])), strict=True):
    if _joint == "head":  # `JOINTS` has no neck; here it is between the head and its parent
        _PARENT_OF["neck"], _parent = _parent, "neck"
    _PARENT_OF[_joint] = _parent
SEVENTEEN = _table(
    "seventeen joints",
    _PARENT_OF,
    dict.fromkeys(["hips", "spine", "chest", "neck", "head"], "xyz")
    | {f"{side}_{limb}": "xyz" for side in ("left", "right") for limb in _LIMBS},
)

_ABOUT_X = ("RightLeg", "RightToeBase", "LeftLeg", "LeftToeBase", "LeftForeArm", "RightForeArm")
_VARYING = {row[0]: row[1] for row in HUMAN36M.rows if not row[0].endswith(("Thumb", "WristEnd"))}
HUMAN36M_TABLE = _table(
    "the columns of Human3.6M that vary",
    _VARYING,
    {joint: "x" if joint in _ABOUT_X else "xyz" for joint in _VARYING},
)

TABLES = {table.name: table for table in (SEVENTEEN, HUMAN36M_TABLE)}
