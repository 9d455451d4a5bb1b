"""A motion: a skeleton and the rotation and translation of each joint in every frame.

A skeleton is a tree of named joints, each at an offset from its parent in the rest pose.

Positions follow by forward kinematics, from the root to the leaves:

    global rotation  G_j = G_parent · R_j
    position         p_j = p_parent + G_parent · t_j

where R_j is the joint's rotation and t_j its translation from the parent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from numpy_cae.motion import quaternions

Joint = TypeVar("Joint")

RATE = 30.0
"""Frames a second of holden2015, section 4: every motion is resampled to it before a network."""
MIN_RATE = 1.0
MAX_RATE = 10_000.0
"""Other rates of files are refused. A few frames of a lower one would last hours and would fill the
memory when they are resampled; no camera that records motions is faster."""


@dataclass(frozen=True, eq=False)
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
        shape = np.shape(self.offsets)
        if len(self.parents) != joints or shape != (joints, 3):
            parts = f"{joints} names, {len(self.parents)} parents and offsets of shape {shape}"
            raise ValueError(f"{parts} do not make a skeleton")
        if len(set(self.names)) != joints:
            twice = sorted({name for name in self.names if self.names.count(name) > 1})
            raise ValueError(f"joint names appear more than once: {', '.join(twice)}")
        for joint, parent in enumerate(self.parents):
            if not (parent == -1 if joint == 0 else 0 <= parent < joint):
                problem = f"joint {self.names[joint]!r} has parent {parent}"
                expected = "the root must be first and every parent before its children"
                raise ValueError(f"{problem}: {expected}")

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
    order = []
    waiting = [root]
    while waiting:
        order.append(waiting.pop())
        waiting += reversed(children.get(order[-1], []))
    return order


@dataclass(frozen=True)
class Note:
    """A message about a motion for a person. Code decides by `kind` and `in_doubt`, not by `text`.

    Parameters
    ----------
    kind : str
        What the note is about: "unit", "skipped lines", "frames", "still", "rig", "up" or "floor".
    text : str
    in_doubt : bool
        Whether what the note says is probably wrong, such as a unit with which nobody is as tall.

    Examples
    --------
    >>> Note("unit", "metres (given)").in_doubt
    False
    """

    kind: str
    text: str
    in_doubt: bool = False


@dataclass(frozen=True, repr=False, eq=False)
class Motion:
    """Frames of a moving skeleton.

    Parameters
    ----------
    skeleton : Skeleton
    rate : float
        Frames a second.
    rotations : (F, J, 4) array of float64
        Each joint's rotation relative to its parent, as unit quaternions (x, y, z, w).
    translations : (F, J, 3) array of float64
        From the parent to the joint in the parent's frame, in metres; for the root, its position
        in the world. A joint without position channels has its offset in every frame.
    unit : float
        Metres in one unit of length of the file that the motion came from.
    notes : tuple of Note
        What the reader took the unit to be and why, then what is odd in the file, how its rig was
        recognised, and the up axis and the floor if the file has others than Y and 0.
    up : str
        The axis that is up in the file, such as "z"; here Y always is.
    floor : float
        Height of the floor in the file in metres along that axis; here it is at 0.

    Examples
    --------
    A knee that is bent by 90 degrees takes the ankle forward or back, here along -Z:

    >>> offsets = np.array([[0, 0.9, 0], [0, -0.45, 0], [0, -0.4, 0]])
    >>> leg = Skeleton(("hip", "knee", "ankle"), (-1, 0, 1), offsets)
    >>> rotations = np.tile([0.0, 0.0, 0.0, 1.0], (1, 3, 1))
    >>> rotations[0, 1] = [np.sin(np.pi / 4), 0, 0, np.cos(np.pi / 4)]
    >>> motion = Motion(leg, 30.0, rotations, leg.offsets[None])
    >>> motion.positions().round(2)[0]
    array([[ 0.  ,  0.9 ,  0.  ],
           [ 0.  ,  0.45,  0.  ],
           [ 0.  ,  0.45, -0.4 ]])
    """

    skeleton: Skeleton
    rate: float
    rotations: np.ndarray
    translations: np.ndarray
    unit: float = 1.0
    notes: tuple[Note, ...] = (Note("unit", "metres"),)
    up: str = "y"
    floor: float = 0.0

    def __post_init__(self) -> None:
        frames, joints = len(self.rotations), len(self.skeleton.names)
        if not (np.isfinite(self.rate) and self.rate > 0):
            raise ValueError(f"rate is {self.rate}, expected frames a second above 0")
        for name, width in (("rotations", 4), ("translations", 3)):
            shape = np.shape(getattr(self, name))
            if shape != (frames, joints, width):
                raise ValueError(f"{name} have shape {shape}, expected {(frames, joints, width)}")

    def __len__(self) -> int:
        return len(self.rotations)

    def __repr__(self) -> str:
        joints = len(self.skeleton.names)
        return f"motion of {len(self)} frames at {self.rate:g} a second, {joints} joints"

    @property
    def note(self) -> str:
        """The texts of the notes in one line."""
        return "; ".join(note.text for note in self.notes)

    @property
    def seconds(self) -> float:
        """Duration of the motion."""
        return len(self) / self.rate

    def save(self, path: str | Path) -> None:
        """Write the motion to a file: a motion that was loaded from one, or made of such a motion,
        knows how (`numpy_cae.mocap.file_motion.FileMotion`).

        Raises ValueError for a motion that was made in memory.
        """
        problem = "the motion comes from no file whose form it could have"
        raise ValueError(f"{path}: {problem}; write it with numpy_cae.save(motion, path)")

    def at(self, frames: np.ndarray | slice) -> Motion:
        """The motion that consists of these frames, in this order."""
        return replace(
            self, rotations=self.rotations[frames], translations=self.translations[frames]
        )

    def sampled(self, poses: int) -> Motion:
        """About this many poses of the motion, evenly spaced; poses with NaN are left out."""
        sample = self.at(slice(None, None, max(1, len(self) // poses)))
        if not _has_nan(sample).any():
            return sample
        # Every n-th frame may be lost.
        there = np.flatnonzero(~_has_nan(self))
        return self.at(there[:: max(1, len(there) // poses)])

    def positions(self, joints: Sequence[int] | None = None) -> np.ndarray:
        """World positions of the joints, or of some, (frames, joints, 3) in metres, Y up."""
        joints = range(len(self.skeleton.names)) if joints is None else joints
        positions = np.empty((len(self), len(joints), 3))
        for frames in blocks(np.arange(len(self))):
            positions[frames] = self.at(frames).forward_kinematics(joints)[0][:, joints]
        return positions

    def forward_kinematics(
        self, joints: Sequence[int] | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """World positions (frames, J, 3) in metres and global rotations (frames, J, 4).

        If `joints` is given, only these joints and their ancestors are computed.
        """
        positions = self.translations.copy()
        rotations = self.rotations.copy()
        needed: set[int] = set()
        for end in range(len(self.skeleton.names)) if joints is None else joints:
            needed.update(self.skeleton.path(end))
        for joint in sorted(needed - {0}):
            parent = self.skeleton.parents[joint]
            of_parent = rotations[:, parent]
            rotations[:, joint] = quaternions.product(of_parent, rotations[:, joint])
            positions[:, joint] = quaternions.rotate(of_parent, positions[:, joint])
            positions[:, joint] += positions[:, parent]
        return positions, rotations

    def resampled(self, rate: float) -> Motion:
        """The same motion at another rate, in frames a second.

        Where the motion's own rate is a multiple of the new one, frames are dropped, as holden2015
        sub-samples 120 Hz to 30 (section 4), and the arrays are views. Otherwise rotations are
        interpolated by slerp and translations linearly.
        """
        frames = self.source_frames(rate)
        if frames.dtype == int:
            # A slice has no arrays of its own: those of an hour at 120 Hz would take 0.2 GB.
            dropped = self.at(slice(None, None, whole_step(self.rate, rate)))
            return replace(dropped, rate=float(rate))
        first = np.minimum(frames.astype(int), len(self) - 2)  # -1, the last frame, of a single one
        share = (frames - first)[:, None]
        rotations = quaternions.slerp(self.rotations[first], self.rotations[first + 1], share)
        way = self.translations[first + 1] - self.translations[first]
        translations = self.translations[first] + share[..., None] * way
        return replace(self, rate=float(rate), rotations=rotations, translations=translations)

    def source_frames(self, rate: float) -> np.ndarray:
        """The times at which `resampled(rate)` takes its poses, in frames of this motion: int if
        frames are only dropped, else float64, such as 1.5 midway between frames 1 and 2."""
        if rate <= 0:
            raise ValueError(f"rate is {rate}, expected frames a second above 0")
        step = whole_step(self.rate, rate)
        if step:
            return np.arange(0, len(self), step)
        last = (len(self) - 1) / self.rate * rate
        return np.arange(int(np.floor(last + 1e-9)) + 1) * (self.rate / rate)


def _has_nan(motion: Motion) -> np.ndarray:
    """Whether a frame has NaN, (frames,)."""
    rotations = np.isnan(motion.rotations).any(axis=(1, 2))
    return np.asarray(rotations | np.isnan(motion.translations).any(axis=(1, 2)))


def require_finite(motion: Motion) -> None:
    """Raise ValueError if a motion has no frames or values that are not finite."""
    if len(motion) == 0:
        raise ValueError("the motion has no frames, expected at least one")
    for values in ("rotations", "translations"):
        finite = np.isfinite(getattr(motion, values))
        if not finite.all():
            frame, joint, _ = np.argwhere(~finite)[0]
            where = f"frame {frame}, joint {motion.skeleton.names[joint]!r}"
            raise ValueError(f"{values} have a value that is not finite: {where}")


def blocks(frames: np.ndarray, size: int = 2048) -> list[np.ndarray]:
    """Ascending frames in pieces, those of each stretch of `size` frames of the motion: work on a
    piece at a time needs little memory for a long motion."""
    parts = np.split(frames, np.flatnonzero(np.diff(frames // size)) + 1)
    return [part for part in parts if len(part)]


def whole_step(rate: float, new_rate: float) -> int:
    """n if every n-th frame at `rate` is a frame at `new_rate`; 0 if there is no such n."""
    step = round(rate / new_rate)
    # Files round frame times (.0083333 for 1/120), and 29.97 Hz may stand for 30: a difference of
    # less than half a percent is ignored here, though `rate` stays as the file has it.
    return step if step >= 1 and abs(rate / new_rate / step - 1) < 0.005 else 0
