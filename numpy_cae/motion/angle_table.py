"""The 54 numbers of a frame, by name: jang2018 represents motion "in joint space, whose dimension
is 54 made by 17 joints".

17 joints of three numbers each are 51; the root's translation makes 54. The poster does not list
the joints; these are the seventeen that papers on Human3.6M draw, five along the trunk and three
for each limb. Collars and toes do not rotate, but are included so that all `JOINTS` can be drawn.

MBR17 drops the constant columns of Human3.6M's own text, which also leaves 54 numbers: 21 joints
rotate, six of them (knees, elbows, toes) about x only. That is the second table.

`angle_table.json` has both: the joints, each with its parent, and the axes about which joints
rotate, in the order of the numbers. Where `JOINTS` has no neck, the first table has one.
"""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

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


def _table(name: str, parent: dict[str, str | None], rotating: dict[str, str]) -> AngleTable:
    """The table with the parent of each joint, and the axes of those that rotate."""
    joints = tuple(parent)
    parents = tuple(-1 if joint is None else joints.index(joint) for joint in parent.values())
    return AngleTable(name, joints, parents, tuple(rotating.items()))


_FILE = Path(__file__).with_suffix(".json").read_text(encoding="utf-8")
TABLES = {name: _table(name, **table) for name, table in json.loads(_FILE).items()}
SEVENTEEN, HUMAN36M_TABLE = TABLES.values()
