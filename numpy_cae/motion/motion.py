"""A motion: a skeleton and, for every frame, how each joint is turned and where it sits.

The positions of the joints follow by forward kinematics, down the tree from the root:

    global rotation  G_j = G_parent · R_j
    position         p_j = p_parent + G_parent · t_j

where R_j is the joint's rotation and t_j its translation from the parent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from numpy_cae.motion.skeleton import Skeleton


@dataclass(frozen=True)
class Motion:
    """Frames of a skeleton in motion.

    Parameters
    ----------
    skeleton : Skeleton
    rate : float
        Frames a second.
    rotations : (F, J, 4) array of float64
        Each joint's rotation relative to its parent, as unit quaternions (x, y, z, w).
    translations : (F, J, 3) array of float64
        From the parent to the joint in the parent's frame, in metres; for the root, its place
        in the world. Where a joint has no position channels this is its offset in every frame.
    unit : float
        Metres in one unit of length of the file that the motion came from.
    unit_note : str
        What the reader took the unit to be and why, for a person.
    """

    skeleton: Skeleton
    rate: float
    rotations: np.ndarray
    translations: np.ndarray
    unit: float = 1.0
    unit_note: str = "metres"

    def __post_init__(self):
        frames, joints = len(self.rotations), len(self.skeleton.names)
        if np.shape(self.rotations) != (frames, joints, 4):
            raise ValueError(
                f"rotations have shape {np.shape(self.rotations)}, expected (frames, {joints}, 4)"
            )
        if np.shape(self.translations) != (frames, joints, 3):
            raise ValueError(
                f"translations have shape {np.shape(self.translations)}, "
                f"expected ({frames}, {joints}, 3)"
            )

    def __len__(self) -> int:
        return len(self.rotations)

    @property
    def seconds(self) -> float:
        """How long the motion lasts."""
        return len(self) / self.rate

    def positions(self) -> np.ndarray:
        """Where every joint is.

        Returns
        -------
        (frames, joints, 3) array of float64
            World positions in metres, Y up.
        """
        positions, _ = self.forward_kinematics()
        return positions

    def forward_kinematics(self) -> tuple[np.ndarray, list[Rotation]]:
        """World positions (F, J, 3) in metres and, for each joint, its F global rotations."""
        positions = np.empty(self.translations.shape)
        turned: list[Rotation] = []
        for joint, parent in enumerate(self.skeleton.parents):
            rotation = Rotation.from_quat(self.rotations[:, joint])
            if parent < 0:
                turned.append(rotation)
                positions[:, joint] = self.translations[:, joint]
            else:
                turned.append(turned[parent] * rotation)
                reach = turned[parent].apply(self.translations[:, joint])
                positions[:, joint] = positions[:, parent] + reach
        return positions, turned

    def resampled(self, rate: float) -> Motion:
        """The same motion at another rate.

        Where the rate goes into the motion's own a whole number of times, frames are left out
        and nothing is computed, as holden2015 sub-samples 120 Hz to 30 (section 4). Elsewhere
        rotations turn along the shortest way (slerp) and translations move along a line.

        Parameters
        ----------
        rate : float
            Frames a second.
        """
        now = self.source_frames(rate)
        if now.dtype == int:
            return replace(
                self,
                rate=float(rate),
                rotations=self.rotations[now],
                translations=self.translations[now],
            )
        then = np.arange(len(self))
        return replace(
            self,
            rate=float(rate),
            rotations=slerp(then, self.rotations, now),
            translations=_along_lines(then, self.translations, now),
        )

    def source_frames(self, rate: float) -> np.ndarray:
        """Where among this motion's frames `resampled` takes its poses.

        Returns
        -------
        (frames at `rate`,) array
            Of int where frames are only left out, else of float64: 1.5 is half way from frame 1
            to frame 2.
        """
        if rate <= 0:
            raise ValueError(f"rate is {rate}, expected frames a second above 0")
        step = whole_step(self.rate, rate)
        if step:
            return np.arange(0, len(self), step)
        last = (len(self) - 1) / self.rate * rate
        return np.arange(int(np.floor(last + 1e-9)) + 1) * (self.rate / rate)


def whole_step(own: float, rate: float) -> int:
    """Every how many-th frame of a motion at its `own` rate is one at `rate`; 0 where none is."""
    step = round(own / rate)
    # Frame times are rounded in files (.0083333, 0.033367): half a percent is the same rate.
    return step if step >= 1 and abs(own / rate / step - 1) < 0.005 else 0


def slerp(then: np.ndarray, rotations: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Rotations along the shortest way: (N, J, 4) quaternions at the times `then`, at `now`."""
    if len(then) == 1:
        return np.repeat(rotations, len(now), axis=0)
    joints = range(rotations.shape[1])
    now = np.clip(now, then[0], then[-1])
    turning = [Slerp(then, Rotation.from_quat(rotations[:, joint])) for joint in joints]
    return np.stack([turn(now).as_quat() for turn in turning], axis=1)


def _along_lines(then: np.ndarray, translations: np.ndarray, now: np.ndarray) -> np.ndarray:
    columns = translations.reshape(len(then), -1).T
    moved = np.stack([np.interp(now, then, column) for column in columns], axis=-1)
    return moved.reshape(len(now), -1, 3)
