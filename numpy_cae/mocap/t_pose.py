"""A T-pose at the start of a motion: arms held out, or no joint rotated, until the body jumps.

Conversions of the CMU database and inertial suits begin with such frames. They are not part of the
motion. A person who was recorded in a T-pose leaves it slowly, and keeps it.
"""

from dataclasses import dataclass

import numpy as np

from numpy_cae.mocap.retargeting.body import body_positions
from numpy_cae.motion import JOINTS, Motion

LONGEST_SECONDS = 3.0
"""A T-pose lasts at most this (s)."""
JUMP_RATIO = 4.0
"""A T-pose ends with a step, the mean of all joints, of more than this times the largest of the ten
steps after it."""
BLEND_SECONDS = 0.1
"""A T-pose may blend into the motion over this time (s), which counts as a part of it: the steps
after the largest one are then still large."""
ARM_DEGREES = 25.0
"""An arm is held out if it is within this angle of the line of the shoulders (°)."""
UNCHANGED = 1e-6
"""A step (m) or a rotation (in quaternions) of no more than this is rounding."""


@dataclass(frozen=True)
class TPose:
    """A T-pose at the start of a motion.

    Parameters
    ----------
    frames : int
        How many frames the T-pose lasts.
    step : float
        The mean step of all joints after it, in metres.
    score : float
        The step divided by the threshold, above 1.
    """

    frames: int
    step: float
    score: float


def leading_t_pose(motion: Motion, body: np.ndarray | None = None) -> TPose | None:
    """The T-pose with which a motion begins; None if there is none.

    Parameters
    ----------
    motion : Motion
        At the rate of its file: resampling would blend the T-pose with the next frames.
    body : (frames, 20, 3) array of float64, optional
        Its `body_positions`, if they are computed already.

    Raises
    ------
    UnknownRigError
        If joints are missing.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> leading_t_pose(motion)
    >>> motion.rotations[0, 1:] = [0.0, 0.0, 0.0, 1.0]
    >>> leading_t_pose(motion).frames
    1
    """
    frames = min(len(motion), round(LONGEST_SECONDS * motion.rate) + 12)
    start = motion.at(slice(frames))
    if frames < 4:
        return None
    positions = body_positions(start) if body is None else body[:frames]
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=-1).mean(axis=1)
    jump = int(np.argmax(steps[: frames - 3]))
    before = float(steps[:jump].max(initial=0.0))
    for end in range(jump + 1, min(jump + 2 + round(BLEND_SECONDS * motion.rate), len(steps))):
        after = float(steps[end : end + 10].max())
        score = float(steps[jump] / max(JUMP_RATIO * max(after, before), UNCHANGED))
        if score > 1 and _is_t_pose(start.at(slice(jump, jump + 1))):
            return TPose(end, float(steps[jump]), score)
    return None


def _is_t_pose(pose: Motion) -> bool:
    """Whether both arms are held out, or no joint but the root is rotated, in a single frame."""
    if np.abs(pose.rotations[:, 1:, :3]).max() < UNCHANGED:
        return True
    at = dict(zip(JOINTS, body_positions(pose)[0], strict=True))
    line = at["left_shoulder"] - at["right_shoulder"]
    left_arm = at["left_wrist"] - at["left_shoulder"]
    right_arm = at["right_shoulder"] - at["right_wrist"]
    arms = np.array([left_arm, right_arm])
    lengths = np.linalg.norm(line) * np.linalg.norm(arms, axis=1)
    return bool(np.all(arms @ line > np.cos(np.radians(ARM_DEGREES)) * lengths))
