"""Which steps a repair by evidence takes, by where the motion comes from."""

from dataclasses import dataclass

import numpy as np

from numpy_cae.cleanup.curves import sliding, usual_body
from numpy_cae.cleanup.interpolated import with_finite_values
from numpy_cae.mocap.t_pose import leading_t_pose
from numpy_cae.motion.filters import LEAST_RATE
from numpy_cae.motion.motion import Motion


@dataclass(frozen=True)
class Preset:
    """What a repair does.

    Parameters
    ----------
    sensitivity : float
        0 to 1: a finding is mended if its confidence is at least 1 - sensitivity.
    smooth : bool
        Whether jitter is removed from the whole motion.
    feet : bool
        Whether feet that stand are held still on the floor.
    cut : bool
        Whether a pose of reference at the start is cut off; else it is kept and not changed.

    Raises
    ------
    ValueError
        If the sensitivity is not above 0 and at most 1.

    Examples
    --------
    >>> print(PRESETS["video"])
    sensitivity 0.6, jitter removed, feet held on the floor, a T-pose at the start kept
    """

    sensitivity: float = 0.5
    smooth: bool = False
    feet: bool = False
    cut: bool = False

    def __post_init__(self) -> None:
        if not 0 < self.sensitivity <= 1:
            raise ValueError(f"sensitivity is {self.sensitivity}, expected above 0 and at most 1")

    def __str__(self) -> str:
        parts = [f"sensitivity {self.sensitivity:g}"]
        parts += ["jitter removed"] * self.smooth + ["feet held on the floor"] * self.feet
        return ", ".join([*parts, f"a T-pose at the start {'cut off' if self.cut else 'kept'}"])


PRESETS = {
    "video": Preset(sensitivity=0.6, smooth=True, feet=True),
    "suit": Preset(feet=True, cut=True),
    "optical": Preset(cut=True),
}
"""Presets for motion estimated from video or depth, of inertial suits, and of optical systems."""
SLIDING_CENTIMETRES = 15.0
"""SLIDING_CENTIMETRES: motion from video has standing feet that slide faster than this (cm/s)."""
ROUGH_RATIO = 0.6
"""ROUGH_RATIO: and joints that move change their step by at least this share of it from frame to
frame, in the median at no more than 30 a second: by 0.64 to 1.67 in seven files from video, by 0.53
in a spinning dancer (docs/lab_book/evidence.md)."""
MOVING_METRES = 0.001
"""MOVING_METRES: joints move if a step is longer than this (m)."""
LONGEST_SECONDS = 20.0
"""LONGEST_SECONDS: no more than this time of a motion is looked at (s)."""


def fitting_preset(motion: Motion) -> str | None:
    """The name of the preset that fits a motion: "video" if its feet slide and it is rough; "suit"
    if it begins with a pose of reference; else None."""
    motion, _ = with_finite_values(motion)
    t_pose = leading_t_pose(motion)
    first = t_pose.frames if t_pose else 0
    some = motion.at(slice(first, first + int(LONGEST_SECONDS * motion.rate)))
    some = some.resampled(30.0) if motion.rate > 40 else some
    noisy = some.rate >= LEAST_RATE and len(some) > 4 and _is_rough(some)
    if noisy and sliding(some) > SLIDING_CENTIMETRES:
        return "video"
    return "suit" if t_pose else None


def shaking(motion: Motion) -> float:
    """The median change of a joint's acceleration from frame to frame, at most 30 a second, of a
    body of a person's size, in metres a second squared; where a pose is repeated nothing shakes."""
    some = motion.resampled(30.0) if motion.rate > 40 else motion
    if len(some) < 4:
        return 0.0
    change = np.linalg.norm(np.diff(usual_body(some), 3, axis=0), axis=-1) * some.rate**2
    return float(np.median(change[change > 0])) if change.any() else 0.0


def _is_rough(motion: Motion) -> bool:
    """Whether joints that move change their step by much of it from frame to frame."""
    body = usual_body(motion)
    steps, changes = (np.linalg.norm(np.diff(body, k, axis=0), axis=-1) for k in (1, 2))
    moving = steps[1:] > MOVING_METRES
    return bool(np.median(changes[moving]) >= ROUGH_RATIO * np.median(steps[1:][moving]))
