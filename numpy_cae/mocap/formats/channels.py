"""A joint's channels in a motion file: their numbers as rotations and translations, and back.

The angles (a, b, c) and (a ± 180°, 180° - b, c ± 180°) are the same rotation, and so are all that
differ by whole turns. The angles nearest to those of the frame before are used, so that curves in
an editor do not jump.
"""

from dataclasses import dataclass, field

import numpy as np

from numpy_cae.motion import quaternions

_BLOCK = 1024
"""_BLOCK: the number of frames that are converted at a time, which fit in the processor's cache."""


@dataclass(frozen=True)
class Channels:
    """The channels of one joint; `first` is the column of the first one in a frame.

    `names` are in the order of the file: "tX", "rZ" (about the own axes) or "tx", "rz" (about fixed
    ones). `unit` is metres in one unit of the file; `offset` (3,) in metres is added to the
    translation. The joint's rotation is orientation · axes · R(angles) · axes⁻¹, quaternions (4,).
    `angle_unit` is radians in one unit of the file's angles.
    """

    names: tuple[str, ...]
    first: int
    unit: float
    offset: np.ndarray = field(default_factory=lambda: np.zeros(3))
    axes: np.ndarray | None = None
    orientation: np.ndarray | None = None
    angle_unit: float = np.radians(1.0)

    def columns(self, kind: str) -> list[int]:
        """The columns of the joint's translations ("t") or rotations ("r") in a frame."""
        return [self.first + n for n, name in enumerate(self.names) if name[0] == kind]

    @property
    def order(self) -> str:
        """The axes of the rotations, named as in `scipy.spatial.transform`."""
        return "".join(name[1] for name in self.names if name[0] == "r")

    @property
    def coordinates(self) -> list[int]:
        """The coordinate of each translation, 0 to 2."""
        return ["xyz".index(name[1].lower()) for name in self.names if name[0] == "t"]

    def position_values(self, translations: np.ndarray) -> np.ndarray:
        """The numbers of the position channels, from translations (F, 3) in metres."""
        return ((translations - self.offset) / self.unit)[:, self.coordinates]

    def rotations(self, values: np.ndarray) -> np.ndarray:
        """The joint's rotations as quaternions (F, 4), from the numbers of its channels (F, N)."""
        angles = values * self.angle_unit
        if self.order.islower():  # fixed axes in this order are own axes in reverse order
            rotations = quaternions.from_angles(self.order[::-1].upper(), angles[:, ::-1])
        else:
            rotations = quaternions.from_angles(self.order, angles)
        if self.axes is not None:
            # C · R · C⁻¹ rotates by the angle of R about its axis rotated by C.
            rotations[:, :3] = quaternions.rotate(self.axes, rotations[:, :3])
        if self.orientation is not None:
            rotations = quaternions.product(self.orientation, rotations)
        return rotations

    def rotation_values(
        self,
        rotations: np.ndarray,
        present: np.ndarray,
        before: np.ndarray | None,
        after: np.ndarray | None,
    ) -> np.ndarray:
        """The numbers of the rotation channels, from quaternions (F, 4).

        They continue the numbers of the frame `before` and of the frame `after`, each None if there
        is none. A jump, if one is necessary, is put where the numbers now in the file, `present`
        (F, N), make their largest step.
        """
        if not self.order:  # a rigid bone
            return np.zeros((len(rotations), 0))
        local = rotations
        if self.orientation is not None:
            local = quaternions.product(quaternions.inverse(self.orientation), local)
        if self.axes is not None:
            inverse = quaternions.inverse(self.axes)
            local = quaternions.product(quaternions.product(inverse, local), self.axes)
        angles = quaternions.nearest_angles(local, self.order)
        if before is not None and after is not None:
            steps = np.abs(np.diff(np.vstack([before, present, after]), axis=0))
            jump = int(np.argmax(steps.max(axis=1)))
        else:
            jump = len(angles) if after is None else 0
        start, end = (present[0] if x is None else x for x in (before, after))
        first = quaternions.continuous_angles(angles[:jump], self.angle_unit * start)
        last = quaternions.continuous_angles(angles[jump:][::-1], self.angle_unit * end)[::-1]
        return np.concatenate([first, last]) / self.angle_unit


def read_pose(
    channels: list[Channels], offsets: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (F, J, 4) and translations (F, J, 3) in metres from a table of numbers (F, C).

    The translation of a joint without position channels is its offset, a row of `offsets` (J, 3).
    """
    rotations = np.empty((len(values), len(channels), 4))
    translations = np.tile(offsets, (len(values), 1, 1))
    for first in range(0, len(values), _BLOCK):
        block = values[first : first + _BLOCK]
        turned, placed = (x[first : first + _BLOCK] for x in (rotations, translations))
        for joint, of_joint in enumerate(channels):
            for coordinate, column in zip(of_joint.coordinates, of_joint.columns("t"), strict=True):
                place = of_joint.offset[coordinate]
                placed[:, joint, coordinate] = place + of_joint.unit * block[:, column]
            turned[:, joint] = of_joint.rotations(block[:, of_joint.columns("r")])
    return rotations, translations
