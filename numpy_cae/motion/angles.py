"""A motion as the 54 numbers a frame of jang2018: the sequence of numbers, and back to a motion.

A joint's rotation is relative to its nearest ancestor in the table (`angles_of`).

The angles have no jumps. v and v - 2πk v/|v| are the same rotation for every integer k, and a
conversion from quaternions returns the vector shorter than π. When a joint rotates through π, its
vector thus jumps to the opposite side of the ball, and a network would have to learn that jump.
Here each frame gets the equivalent vector nearest to that of the frame before (as in MBR17 and
Grassia, 1998).

The 54 numbers of a frame, by name: jang2018 represents motion "in joint space, whose dimension
is 54 made by 17 joints".

17 joints of three numbers each are 51; the root's translation makes 54. The poster does not list
the joints; these are the seventeen that papers on Human3.6M draw, five along the trunk and three
for each limb. Collars and toes do not rotate, but are included so that all `JOINTS` can be drawn.

MBR17 drops the constant columns of Human3.6M's own text, which also leaves 54 numbers: 21 joints
rotate, six of them (knees, elbows, toes) about x only. That is the second table.

`angles.json` has both: the joints, each with its parent, and the axes about which joints
rotate, in the order of the numbers. Where `JOINTS` has no neck, the first table has one.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from numpy_cae.motion import quaternions
from numpy_cae.motion.motion import Motion, Skeleton

TRANSLATION = slice(0, 3)
"""The root's translation, metres, relative to the first frame of a clip. Then come the angles."""
ANGLES = slice(3, 54)
"""Rotation vectors (exponential maps) in radians."""


class AngleTable:
    """The meaning of the 54 numbers.

    Parameters
    ----------
    name : str
    parent : dict of joint to joint or None
        The parent of each joint, None of the root.
    rotating : dict of joint to axes
        The joints that rotate, each with the axes that have an angle, in the order of the numbers.

    Attributes
    ----------
    joints, parents : tuples of str and int
        The joints, and the index of the parent of each.
    columns : tuple of str
        A name for each of the 54 numbers: "translation x", …, "hips x", …
    indices : (51,) array of int
        The indices of the 51 angles among the 3J numbers of all joints.
    rotating_parents : list of int
        For each joint the nearest ancestor that rotates, -1 for the root.
    """

    def __init__(self, name: str, parent: dict[str, str | None], rotating: dict[str, str]):
        self.name = name
        self.joints = tuple(parent)
        self.parents = tuple(-1 if p is None else self.joints.index(p) for p in parent.values())
        columns = ["translation x", "translation y", "translation z"]
        indices = []
        for joint, axes in rotating.items():
            for axis in axes:
                columns.append(f"{joint} {axis}")
                indices.append(3 * self.joints.index(joint) + "xyz".index(axis))
        self.columns = tuple(columns)
        self.indices = np.array(indices)
        self.rotating_parents: list[int] = []
        for ancestor in self.parents:
            while ancestor >= 0 and self.joints[ancestor] not in rotating:
                ancestor = self.parents[ancestor]
            self.rotating_parents.append(ancestor)


_FILE = Path(__file__).with_suffix(".json").read_text(encoding="utf-8")
TABLES = {name: AngleTable(name, **table) for name, table in json.loads(_FILE).items()}
SEVENTEEN, HUMAN36M_TABLE = TABLES.values()


ANGLE_RATE = 25.0
"""Frames a second, MBR17's rate for Human3.6M: half of its fifty."""
_PERIOD = 2 * np.pi
_SHORT = 1e-9
"""A vector shorter than this has no meaningful direction."""


@dataclass(frozen=True, eq=False)
class AngleSequence:
    """A motion in joint space.

    Parameters
    ----------
    numbers : (F, 54) array of float64
        The root's position in metres and 51 angles in radians, unwrapped in time, in the order of
        `table.columns`.
    table : AngleTable
    offsets : (J, 3) array of float64
        From each joint's nearest rotating ancestor to the joint in metres, mean over the motion.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import angles_of
    >>> walk = angles_of(make_take("walk", 1, seconds=2.0, rate=50.0).motion)
    >>> walk.numbers.shape, walk.table.columns[3]
    ((50, 54), 'hips x')
    """

    numbers: np.ndarray
    table: AngleTable
    offsets: np.ndarray

    def __len__(self) -> int:
        return len(self.numbers)


def motion_of(numbers: np.ndarray, table: AngleTable, offsets: np.ndarray) -> Motion:
    """The motion, at 25 frames a second, that 54 numbers a frame describe.

    Parameters
    ----------
    numbers : (F, 54) array of float
        As in `AngleSequence`; the first three are the root's position in the world. In a clip they
        are relative to its first frame (see `on_floor`).
    table : AngleTable
    offsets : (J, 3) array of float64
        As in `AngleSequence`.

    Returns
    -------
    Motion
        Its joints are those of the table.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import angles_of
    >>> walk = angles_of(make_take("walk", 1, seconds=2.0, rate=50.0).motion)
    >>> motion = motion_of(walk.numbers, walk.table, walk.offsets)
    >>> len(motion), motion.rate
    (50, 25.0)
    """
    frames = len(numbers)
    joints = len(table.joints)
    vectors = np.zeros((frames, 3 * joints))
    vectors[:, table.indices] = numbers[:, TRANSLATION.stop :]
    # If a joint's parent does not rotate, the offsets of both are from the same rotating ancestor;
    # the difference is the bone between them.
    local = np.array(offsets, dtype=np.float64)
    for joint, parent in enumerate(table.parents):
        if parent != table.rotating_parents[joint]:
            local[joint] -= offsets[parent]
    translations = np.tile(local, (frames, 1, 1))
    translations[:, 0] = numbers[:, TRANSLATION]
    rotations = quaternions.from_vector(vectors.reshape(frames, joints, 3))
    skeleton = Skeleton(table.joints, table.parents, local)
    return Motion(skeleton, ANGLE_RATE, rotations, translations)


def on_floor(motion: Motion) -> Motion:
    """The motion moved vertically so that its lowest joint touches the floor once.

    A clip needs this: its translation is relative to its first frame, whose height is unknown.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    Motion

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 1, seconds=2.0, rate=30.0).motion
    >>> bool(abs(on_floor(walk).positions()[..., 1].min()) < 1e-9)
    True
    """
    translations = motion.translations.copy()
    translations[:, 0, 1] -= motion.positions()[..., 1].min()
    return replace(motion, translations=translations)


def unwrap(vectors: np.ndarray) -> np.ndarray:
    """The same rotations, continuous in time: rotation vectors (F, …, 3) in radians. From the
    second frame on, each is replaced by the equivalent vector nearest to that of the frame before.
    """
    smooth = np.array(vectors, dtype=np.float64)
    if np.linalg.norm(smooth, axis=-1).max(initial=0.0) < np.pi / 2:
        return smooth  # no equivalent vector is nearer
    for frame in range(1, len(smooth)):
        smooth[frame] = _nearest(smooth[frame], smooth[frame - 1])
    return smooth


def _nearest(vector: np.ndarray, before: np.ndarray) -> np.ndarray:
    """The vector (…, 3) nearest to `before` among those that are equivalent to `vector`."""
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    # Equivalent vectors lie on one line. If there is no rotation, the line may have any direction
    # (2π about any axis); the direction of the frame before keeps the trajectory straight.
    axis = np.where(angle > _SHORT, vector, before)
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = axis / np.where(length > _SHORT, length, 1.0)
    turns = np.round((np.sum(before * axis, axis=-1, keepdims=True) - angle) / _PERIOD)
    return vector + _PERIOD * turns * axis


def remove_whole_turns(vectors: np.ndarray) -> np.ndarray:
    """Continuous rotation vectors (…, F, J, 3) of clips, shifted by whole turns to the shortest.

    After a person has turned round once, the root's vector is 2π longer from there on; that should
    not make later clips differ from earlier ones. The shift is one number for each joint and clip,
    so that the clip stays continuous.
    """
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    turns = np.round(angle.mean(axis=-3, keepdims=True) / _PERIOD)
    if not turns.any():
        return vectors
    return vectors * (1 - _PERIOD * turns / np.where(angle > _SHORT, angle, 1.0))
