"""A joint's channels of a motion file: from rotations and translations back to their numbers.

Three angles and (a ± 180°, 180° - b, c ± 180°), each plus whole turns, are the same rotation. Of
these the ones nearest to the frame before are used, so that curves in an editor do not jump.
"""

import warnings
from dataclasses import dataclass, field
from itertools import permutations
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class Channels:
    """The channels of one joint.

    Parameters
    ----------
    names : tuple of str
        In the order of the file: "tX", "rZ" (about the own axes) or "tx", "rz" (about fixed ones).
    first : int
        The place of the first among the numbers of a frame.
    unit : float
        Metres in one unit of the file.
    offset : (3,) array
        Metres, added to the translation.
    axes, orientation : Rotation, optional
        The joint's rotation is orientation · axes · R(angles) · axes⁻¹.
    degrees : bool
    limits : (number of angles, 2) array, optional
        Smallest and largest angles, in the unit of the file.
    """

    names: tuple[str, ...]
    first: int
    unit: float
    offset: np.ndarray = field(default_factory=lambda: np.zeros(3))
    axes: Rotation | None = None
    orientation: Rotation | None = None
    degrees: bool = True
    limits: np.ndarray | None = None

    def columns(self, kind: str) -> list[int]:
        """The places of its translations ("t") or rotations ("r") among the numbers of a frame."""
        return [self.first + n for n, name in enumerate(self.names) if name[0] == kind]

    @property
    def order(self) -> str:
        """The axes of the rotations as in `scipy.spatial.transform`."""
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
        order, angles = self.order, values * (np.radians(1.0) if self.degrees else 1.0)
        if order.islower():  # fixed axes are the joint's own in reverse
            order, angles = order[::-1].upper(), angles[:, ::-1]
        found = quaternions(order, angles)
        if self.axes is not None:
            # C · R · C⁻¹ rotates by the angle of R about its axis rotated by C.
            found[:, :3] = self.axes.apply(found[:, :3])
        if self.orientation is not None:
            found = (self.orientation * Rotation.from_quat(found)).as_quat()
        return found

    def rotation_values(
        self,
        rotations: np.ndarray,
        present: np.ndarray,
        before: np.ndarray | None,
        after: np.ndarray | None,
    ) -> np.ndarray:
        """The numbers of the rotation channels, from quaternions (F, 4).

        They continue the numbers of the frames before and after them, where there are such. If
        they cannot continue both, they jump where their `present` numbers (F, N) do.
        """
        local = Rotation.from_quat(rotations)
        if self.orientation is not None:
            local = self.orientation.inv() * local
        if self.axes is not None:
            local = self.axes.inv() * local * self.axes
        angles = nearest_angles(local, self.order)
        unit = np.radians(1.0) if self.degrees else 1.0
        jump = 0 if before is None else len(angles)
        if before is None and after is None:
            before, jump = present[0], len(angles)
        elif before is not None and after is not None:
            steps = np.abs(np.diff(np.vstack([before, present, after]), axis=0))
            jump = int(np.argmax(steps.max(axis=1)))
        parts = []
        if jump > 0 and before is not None:
            parts.append(continuous_angles(angles[:jump], unit * before))
        if jump < len(angles) and after is not None:
            parts.append(continuous_angles(angles[jump:][::-1], unit * after)[::-1])
        angles = np.concatenate(parts) / unit
        if self.limits is None:
            return angles
        # Files exceed their limits; a stretch then may as far as its neighbours do.
        around = [self.limits.T, *(end[None] for end in (before, after) if end is not None)]
        return np.clip(angles, np.vstack(around).min(axis=0), np.vstack(around).max(axis=0))


def read_pose(
    channels: list[Channels], offsets: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (F, J, 4) and translations (F, J, 3) in metres from a table of numbers (F, C).

    A joint without position channels has its offset, of `offsets` (J, 3), in every frame.
    """
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (len(values), len(channels), 1))
    translations = np.tile(offsets, (len(values), 1, 1))
    for joint, own in enumerate(channels):
        for coordinate, column in zip(own.coordinates, own.columns("t"), strict=True):
            place = own.offset[coordinate]
            translations[:, joint, coordinate] = place + own.unit * values[:, column]
        rotations[:, joint] = own.rotations(values[:, own.columns("r")])
    return rotations, translations


def quaternions(order: str, angles: np.ndarray) -> np.ndarray:
    """(F, 4), x y z w, of angles (F, N) in radians about the joint's own axes in this order.

    A rotation by 2α about axis i, on the right of the others', changes the quaternion to

        q_i cos α + q_w sin α,   q_j cos α + q_k sin α,   q_k cos α - q_j sin α,
        q_w cos α - q_i sin α

    As `Rotation.from_euler`, which takes four times as long.
    """
    q = [*np.zeros((3, len(angles))), np.ones(len(angles))]
    for axis, column in zip(order, angles.T, strict=True):
        i = "XYZ".index(axis)
        j, k = (i + 1) % 3, (i + 2) % 3
        sin, cos = np.sin(column / 2), np.cos(column / 2)
        q[i], q[3] = q[i] * cos + q[3] * sin, q[3] * cos - q[i] * sin
        q[j], q[k] = q[j] * cos + q[k] * sin, q[k] * cos - q[j] * sin
    return np.stack(q, axis=1)


def continuous_angles(angles: np.ndarray, before: np.ndarray | None = None) -> np.ndarray:
    """The same rotations by angles (F, 1 to 3) in radians without avoidable jumps from frame to
    frame, beginning near the angles `before` (N,)."""
    if angles.shape[1] == 3:
        before = angles[0] if before is None else before
        other = angles * [1, -1, 1] + np.pi
        from_one = _distance(np.vstack([before, angles[:-1]]), angles)
        from_other = _distance(np.vstack([before, angles[:-1]]), other)
        use_other = np.cumsum(from_other < from_one) % 2 == 1
        angles = np.where(use_other[:, None], other, angles)
    if before is None:
        return np.unwrap(angles, axis=0)
    return np.unwrap(np.vstack([before, angles]), axis=0)[1:]


def _distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The largest difference of angles (F, 3), without regard to whole turns."""
    difference = (one - other + np.pi) % (2 * np.pi) - np.pi
    return np.abs(difference).max(axis=-1)


def nearest_angles(rotations: Rotation, order: str) -> np.ndarray:
    """The angles (F, N) in radians about these axes whose rotation is nearest.

    For fewer than three axes, an angle is dropped of each decomposition into three that keeps the
    order, and the best is taken.
    """
    found = np.zeros((len(rotations), len(order)))
    least = np.full(len(rotations), np.inf if order else -np.inf)
    three: Any
    for three in map("".join, permutations("XYZ" if order.isupper() else "xyz")):
        places = [three.index(axis) for axis in order]
        if places == sorted(places):
            with warnings.catch_warnings():
                # At a pole scipy sets one angle to zero and warns; the rotation is the same.
                warnings.filterwarnings("ignore", message="Gimbal lock")
                angles = rotations.as_euler(three)[:, places]
            if len(order) == 3:
                return angles
            miss = (Rotation.from_euler(order, angles).inv() * rotations).magnitude()
            found[miss < least] = angles[miss < least]
            least = np.minimum(least, miss)
    return found
