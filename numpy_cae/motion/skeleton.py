"""A skeleton: a tree of named joints, each at an offset from its parent in the rest pose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

Joint = TypeVar("Joint")


@dataclass(frozen=True)
class Skeleton:
    """A tree of joints, parents before children; the first joint is the root.

    Raises ValueError if the lengths differ, a name is repeated, or a parent is not before its
    child.

    Parameters
    ----------
    names : tuple of J str
    parents : tuple of J int
        The index of each joint's parent, -1 for the root.
    offsets : (J, 3) array of float64
        From the parent to the joint in the rest pose, in metres, Y up.
    end_sites : dict of int to (3,) array
        The tip of a bone that ends at no joint (toes, fingers, the top of the head), as an offset
        in metres from the joint at its base.

    Examples
    --------
    >>> offsets = np.array([[0, 0.9, 0], [0, -0.45, 0], [0, -0.4, 0]])
    >>> leg = Skeleton(("hip", "knee", "ankle"), (-1, 0, 1), offsets)
    >>> leg.path(leg.index("ankle"))
    [2, 1, 0]
    >>> leg.rest_positions()[2].round(2)
    array([0.  , 0.05, 0.  ])
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: np.ndarray
    end_sites: dict[int, np.ndarray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        joints = len(self.names)
        if len(self.parents) != joints or np.shape(self.offsets) != (joints, 3):
            raise ValueError(
                f"{joints} names, {len(self.parents)} parents and offsets of shape "
                f"{np.shape(self.offsets)} do not make a skeleton"
            )
        if len(set(self.names)) != joints:
            twice = sorted({name for name in self.names if self.names.count(name) > 1})
            raise ValueError(f"joint names appear more than once: {', '.join(twice)}")
        for joint, parent in enumerate(self.parents):
            if not (parent == -1 if joint == 0 else 0 <= parent < joint):
                raise ValueError(
                    f"joint {self.names[joint]!r} has parent {parent}: "
                    "the root must be first and every parent before its children"
                )

    def index(self, name: str) -> int:
        """The index of a joint; KeyError, listing the names of the skeleton, if it is unknown."""
        try:
            return self.names.index(name)
        except ValueError:
            raise KeyError(f"no joint {name!r}; the skeleton has {', '.join(self.names)}") from None

    def children(self, joint: int) -> list[int]:
        """The joints whose parent is `joint`."""
        return [child for child, parent in enumerate(self.parents) if parent == joint]

    def rest_positions(self) -> np.ndarray:
        """Positions (J, 3) in metres where nothing is rotated and the root is at its offset."""
        positions = np.array(self.offsets, dtype=np.float64)
        for joint, parent in enumerate(self.parents[1:], start=1):
            positions[joint] += positions[parent]
        return positions

    def scaled(self, factor: float) -> Skeleton:
        """The skeleton with all lengths multiplied by a factor."""
        end_sites = {joint: factor * tip for joint, tip in self.end_sites.items()}
        return replace(self, offsets=factor * self.offsets, end_sites=end_sites)

    def path(self, joint: int) -> list[int]:
        """The joint, its parent and so on up to the root."""
        path = [joint]
        while self.parents[path[-1]] >= 0:
            path.append(self.parents[path[-1]])
        return path


def depth_first(root: Joint, children: Mapping[Joint, list[Joint]]) -> list[Joint]:
    """The joints of a tree, each followed by everything below it.

    Examples
    --------
    >>> depth_first("hips", {"hips": ["spine", "leg"], "spine": ["head"]})
    ['hips', 'spine', 'head', 'leg']
    """
    order, waiting = [], [root]
    while waiting:
        order.append(waiting.pop())
        waiting += reversed(children.get(order[-1], []))
    return order
