"""A pose of reference at the start: arms held out, or no joint rotated, until the body jumps.

Conversions of the CMU database and inertial suits begin with such frames. A person who was recorded
in a T-pose leaves it slowly.
"""

import numpy as np

from numpy_cae.mocap.retarget.body import body_positions
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.finding import BODY, Finding
from numpy_cae.repair.jumps import STILL, confidence

LONGEST = 3.0
"""LONGEST: a pose of reference lasts at most this (s)."""
JUMP = 4.0
"""JUMP: it ends with a step, the mean of all joints, of more than this times the largest of the ten
steps after it."""
COSINE = np.cos(np.radians(25.0))
"""COSINE: an arm that is held out is along the line of the shoulders by this cosine or more."""


def find_t_pose(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """At most one finding, of kind "T-pose".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[0, 1:] = [0.0, 0.0, 0.0, 1.0]
    >>> find_t_pose(motion)
    [body: frame 0: T-pose (...
    """
    frames = min(len(motion), round(LONGEST * motion.rate) + 12)
    start = motion.at(slice(frames))
    if frames < 4:
        return []
    steps = np.linalg.norm(np.diff(body_positions(start), axis=0), axis=-1).mean(axis=1)
    jump = int(np.argmax(steps[: frames - 3]))
    after = float(steps[jump + 1 : jump + 11].max())
    before = float(steps[:jump].max(initial=0.0))
    score = steps[jump] / max(JUMP * max(after, before), STILL)
    if score * 2 * sensitivity <= 1 or not is_reference(start.at(slice(jump, jump + 1))):
        return []
    why = f"arms held out, then all joints move by {100 * steps[jump]:.0f} cm in a frame"
    return [Finding(BODY, (0, jump), "T-pose", why, 0.0, confidence(score))]


def is_reference(pose: Motion) -> bool:
    """Whether both arms are held out, or no joint but the root is rotated."""
    if np.abs(pose.rotations[:, 1:, :3]).max() < STILL:
        return True
    body = body_positions(pose)[0]
    ends = [[JOINTS.index(f"{x}_{y}") for y in ("shoulder", "wrist")] for x in ("left", "right")]
    (left, left_wrist), (right, right_wrist) = body[ends]
    line, arms = left - right, np.array([left_wrist - left, right - right_wrist])
    lengths = np.linalg.norm(line) * np.linalg.norm(arms, axis=1)
    return bool(np.all(arms @ line > COSINE * lengths))
