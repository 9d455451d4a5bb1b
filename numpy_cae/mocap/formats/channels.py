"""A joint's channels in a motion file: their numbers as rotations and translations, and back.

The angles (a, b, c) and (a ± 180°, 180° - b, c ± 180°) are the same rotation, and so are all that
differ by whole turns. The angles nearest to those of the frame before are used, so that curves in
an editor do not jump.
"""

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.motion import quaternions

_BLOCK = 256
"""The number of frames that are converted at a time, which fit in the processor's cache."""


@dataclass(frozen=True, eq=False)
class Channels:
    """The channels of one joint.

    `names` are in the order of the file: "tX", "rZ" (about the own axes) or "tx", "rz" (about fixed
    ones). `unit` is metres in one unit of the file; `offset` (3,) in metres is added to the
    translation. The joint's rotation is orientation · axes · R(angles) · axes⁻¹, quaternions (4,).
    `angle_unit` is radians in one unit of the file's angles.
    """

    names: tuple[str, ...]
    unit: float
    offset: np.ndarray = field(default_factory=lambda: np.zeros(3))
    axes: np.ndarray | None = None
    orientation: np.ndarray | None = None
    angle_unit: float = np.radians(1.0)

    def places(self, kind: str) -> list[int]:
        """The places of the translations ("t") or rotations ("r") among the channels."""
        return [place for place, name in enumerate(self.names) if name[0] == kind]

    @property
    def order(self) -> str:
        """The axes of the rotations, named as in `scipy.spatial.transform`."""
        return "".join(name[1] for name in self.names if name[0] == "r")

    @property
    def coordinates(self) -> list[int]:
        """The coordinate of each translation, 0 to 2."""
        return ["xyz".index(name[1].lower()) for name in self.names if name[0] == "t"]

    def rotations(self, values: np.ndarray) -> np.ndarray:
        """The joint's rotations as quaternions (F, 4), from the numbers of its channels (F, N)."""
        return self.in_parent(quaternions.from_angles(self.order, values * self.angle_unit))

    def in_parent(self, rotations: np.ndarray) -> np.ndarray:
        """The joint's rotations (F, 4), from those about the axes of its channels, which change."""
        if self.axes is not None:
            # C · R · C⁻¹ rotates by the angle of R about its axis rotated by C.
            rotations[:, :3] = quaternions.rotate(self.axes, rotations[:, :3])
        if self.orientation is not None:
            rotations = quaternions.product(self.orientation, rotations)
        return rotations

    def rotation_values(
        self, rotations: np.ndarray, present: np.ndarray, before: np.ndarray, after: np.ndarray
    ) -> np.ndarray:
        """The numbers of the rotation channels, from quaternions (F, 4).

        They continue the numbers of the frame `before` (1, N) and of the frame `after` (1, N), each
        (0, N) if there is none. A jump, if one is necessary, is put where the numbers now in the
        file, `present` (F, N), make their largest step.
        """
        local = rotations
        if self.orientation is not None:
            local = quaternions.product(quaternions.inverse(self.orientation), local)
        if self.axes is not None:
            inverse = quaternions.inverse(self.axes)
            local = quaternions.product(quaternions.product(inverse, local), self.axes)
        angles = quaternions.nearest_angles(local, self.order)
        jump = 0 if len(after) else len(angles)
        if len(before) and len(after):
            steps = np.abs(np.diff(np.vstack([before, present, after]), axis=0))
            jump = int(np.argmax(steps.max(axis=1, initial=0.0)))
        start = before[0] if len(before) else present[0]
        end = after[0] if len(after) else present[0]
        first = quaternions.continuous_angles(angles[:jump], self.angle_unit * start)
        last = quaternions.continuous_angles(angles[jump:][::-1], self.angle_unit * end)[::-1]
        return np.concatenate([first, last]) / self.angle_unit


JointChannels = dict[str, Channels]
"""The channels of each joint by its name, in the order of the skeleton's joints."""


def columns_of(channels: JointChannels) -> list[np.ndarray]:
    """The columns of each joint in a frame, which has the numbers of one joint after the other."""
    ends = np.cumsum([len(of_joint.names) for of_joint in channels.values()])
    return np.split(np.arange(ends[-1]), ends[:-1])


def read_pose(
    channels: JointChannels, offsets: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (F, J, 4) and translations (F, J, 3) in metres from a table of numbers (F, C).

    The translation of a joint without position channels is its offset, a row of `offsets` (J, 3).
    """
    translations = np.tile(offsets, (len(values), 1, 1))
    rotations = np.empty((len(values), len(channels), 4))
    turns: dict[tuple[str, float], dict[int, np.ndarray]] = defaultdict(dict)
    columns = columns_of(channels)
    for joint, of_joint in enumerate(channels.values()):
        coordinates = of_joint.coordinates
        if coordinates:
            lengths = of_joint.unit * values[:, columns[joint][of_joint.places("t")]]
            translations[:, joint, coordinates] = of_joint.offset[coordinates] + lengths
        alike = turns[of_joint.order, of_joint.angle_unit]
        alike[joint] = columns[joint][of_joint.places("r")]
    for (order, unit), alike in turns.items():
        columns_alike = np.array(list(alike.values()))
        # Often these are all joints, and a slice is assigned faster than a list of indices.
        joints = list(alike) if len(turns) > 1 else slice(None)
        for first in range(0, len(values), _BLOCK):
            frames = slice(first, first + _BLOCK)
            angles = unit * values[frames].take(columns_alike, axis=1)
            rotations[frames, joints] = quaternions.from_angles(order, angles)
    for joint, of_joint in enumerate(channels.values()):
        if of_joint.axes is not None or of_joint.orientation is not None:
            rotations[:, joint] = of_joint.in_parent(rotations[:, joint])
    return rotations, translations
