"""Which steps a repair by evidence takes, by where the motion comes from."""

from dataclasses import dataclass

import numpy as np

from numpy_cae.mocap.retarget.body import body_positions
from numpy_cae.motion.contacts import foot_sliding
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.finding import Finding
from numpy_cae.repair.jitter import ROUGH, jumping_steps
from numpy_cae.repair.t_pose import find_t_pose


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

    def is_sure(self, finding: Finding) -> bool:
        """Whether a finding is mended."""
        return finding.confidence >= 1 - self.sensitivity

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
SHAKES, JUMPY, SLIDES = 20.0, 0.02, 20.0
"""SHAKES, JUMPY, SLIDES: the accelerations of motion from video change by more than SHAKES (m/s²)
from frame to frame, in the median of all joints and frames at 30 a second; or joints jump in more
than this part of the frames (`jumping_steps`) and in more than two, as a limb jumps that is turned
for a while, and standing feet slide faster than SLIDES (cm/s; docs/lab_book/evidence.md)."""


def fitting_preset(motion: Motion) -> str | None:
    """The name of the preset that fits a motion: "video" if it shakes, or jumps and slides; "suit"
    if it begins with a pose of reference; else None."""
    t_pose = find_t_pose(motion)
    first = t_pose[0].frames[1] + 1 if t_pose else 0
    some = motion.at(slice(first, first + int(20 * motion.rate)))
    some = some.resampled(30.0) if motion.rate > 40 else some
    if len(some) > 4:
        body = body_positions(some)
        change = np.diff(body, 3, axis=0) * some.rate**2
        jumps = jumping_steps(some, rough=ROUGH).any(axis=1).sum() > max(JUMPY * len(some), 2)
        if np.median(np.linalg.norm(change, axis=-1)) > SHAKES or (
            jumps and foot_sliding(body, some.rate) > SLIDES
        ):
            return "video"
    return "suit" if t_pose else None
