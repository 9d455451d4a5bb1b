"""Which steps a repair by evidence takes, by where the motion comes from."""

from dataclasses import dataclass

import numpy as np

from numpy_cae.cleanup.interpolation import with_finite_values
from numpy_cae.cleanup.measures import HIGHEST_RATE, count_kinks
from numpy_cae.cleanup.view import View
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
        if self.smooth:
            parts.append("jitter removed")
        if self.feet:
            parts.append("feet held on the floor")
        parts.append(f"a T-pose at the start {'cut off' if self.cut else 'kept'}")
        return ", ".join(parts)


PRESETS = {
    "video": Preset(sensitivity=0.6, smooth=True, feet=True),
    "suit": Preset(feet=True, cut=True),
    "optical": Preset(cut=True),
}
"""Presets for motion estimated from video or depth, of inertial suits, and of optical systems."""
VIDEO_SLIDING_CENTIMETRES = 15.0
"""Motion from video has standing feet that slide faster than this (cm/s)."""
VIDEO_ROUGH_RATIO = 0.6
"""In motion from video, joints that move change their step by at least this share of it from frame
to frame, in the median at no more than 30 a second: by 0.64 to 1.67 in seven files from video, by
0.53 in a spinning dancer (docs/lab_book/evidence.md)."""
MOVING_METRES = 0.001
"""Joints move if a step is longer than this (m)."""
INSPECTED_SECONDS = 20.0
"""No more than this time of a motion is looked at (s)."""

LEAST_KINKS = 4
"""Motion needs smoothing if it has at least this many kinks (`measures.count_kinks`)."""
LEAST_KINKS_A_SECOND = 0.5
"""Motion needs smoothing if it has at least this many kinks a second: 1 of 97 takes of CMU at 120
frames a second, none at 24 and 30, none of 116 takes of Bandai."""


def kinks_to_smooth(motion: Motion) -> int:
    """How many kinks a motion has, if they are so many that `smooth` suits it; else 0."""
    motion, _ = with_finite_values(motion)
    t_pose = leading_t_pose(motion)
    view = View(motion.at(slice(t_pose.frames, None)) if t_pose else motion)
    if view.rate < LEAST_RATE:
        return 0
    kinks = count_kinks(view)
    many = max(LEAST_KINKS, LEAST_KINKS_A_SECOND * view.motion.seconds)
    return kinks if kinks >= many else 0


def fitting_preset(motion: Motion) -> str | None:
    """The name of the preset that fits a motion: "video" if its feet slide and it is rough; "suit"
    if it begins with a pose of reference; else None."""
    motion, _ = with_finite_values(motion)
    t_pose = leading_t_pose(motion)
    first = t_pose.frames if t_pose else 0
    some = motion.at(slice(first, first + int(INSPECTED_SECONDS * motion.rate)))
    view = View(some.resampled(30.0) if motion.rate > HIGHEST_RATE else some)
    is_measurable = view.rate >= LEAST_RATE and len(view) > 4
    if is_measurable and _is_rough(view) and view.sliding > VIDEO_SLIDING_CENTIMETRES:
        return "video"
    return "suit" if t_pose else None


def _is_rough(view: View) -> bool:
    """Whether joints that move change their step by much of it from frame to frame."""
    steps = np.linalg.norm(np.diff(view.body, axis=0), axis=-1)
    changes = np.linalg.norm(np.diff(view.body, 2, axis=0), axis=-1)
    moving = steps[1:] > MOVING_METRES
    share = VIDEO_ROUGH_RATIO * np.median(steps[1:][moving])
    return bool(np.median(changes[moving]) >= share)
