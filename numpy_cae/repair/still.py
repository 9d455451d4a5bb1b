"""Frames that stand still until the motion jumps: repeated frames, frozen rotations, a T-pose at
the start (its rule is in `mocap.t_pose`).

Dropped frames, a sensor that stops and a pose of reference look like this. A person who stands
still is never exactly still, a channel that is not used does not jump, and a joint at its limit
returns to the same value.
"""

from collections.abc import Iterator

import numpy as np

from numpy_cae.mocap.t_pose import leading_t_pose
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.curves import STILL_METRES, Curve, Segment, curves_of
from numpy_cae.repair.finding import BODY, Finding, confidence

CAUGHT_UP_RATIO = 2.5
"""CAUGHT_UP_RATIO: what stood still ends with a step of more than this times the median of the
three steps after it."""
FROZEN_SECONDS = 0.2
"""FROZEN_SECONDS: a rotation is frozen if it stands still for at least this time (s)."""
FROZEN_FRAMES = 6
"""FROZEN_FRAMES: a rotation is frozen if it stands still for at least so many steps."""
FROZEN_JUMP_METRES = 0.03
"""FROZEN_JUMP_METRES: a frozen rotation then jumps by more than this (m)."""
FROZEN_JUMP_METRES_A_SECOND = 1.5
"""FROZEN_JUMP_METRES_A_SECOND: a frozen rotation then jumps faster than this (m/s)."""
UNUSED_SHARE = 0.75
"""UNUSED_SHARE: a rotation that stands still for more than this share of the file is not frozen,
but not used."""


def find_still(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """Findings of the kinds "repeated" (the whole body) and "frozen" (one rotation).

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("run", 0, seconds=2.0, rate=30.0).motion
    >>> find_still(motion.at(np.r_[:30, [29] * 5, 35:60]))
    [body: frames 30 to 34: repeated (...
    """
    curves = [curve for curve in curves_of(motion) if curve.spike_kind != "length"]
    body = np.zeros(max(len(motion) - 1, 0))
    frozen = list[Finding]()
    for curve in curves:
        steps = curve.steps()
        body += steps / len(curves)
        frozen += _frozen(curve, steps, sensitivity)
    repeated = list(_repeated(body, sensitivity)) if curves else []
    covered = {frame for f in repeated for frame in range(f.frames[0], f.frames[1] + 1)}
    found = repeated + [f for f in frozen if not covered.issuperset(range(*f.frames))]
    # A body that stands still from the first frame on begins so: nothing says what it did before.
    start = int(np.argmax(np.append(body, np.inf) > STILL_METRES))
    return [finding for finding in found if finding.frames[1] > start]


def _repeated(steps: np.ndarray, sensitivity: float) -> Iterator[Finding]:
    """The runs of frames that repeat the pose of the frame before them."""
    for segment, into in _still_segments(steps, 1, 0.0, sensitivity):
        # A jump into the run shows that its first pose is wrong too.
        yield _finding(BODY, "repeated", segment, segment.first + (into <= 1))


def _frozen(curve: Curve, steps: np.ndarray, sensitivity: float) -> Iterator[Finding]:
    """The runs of frames in which a rotation stands still and then jumps."""
    if not curve.is_rotation or np.mean(steps <= STILL_METRES) >= UNUSED_SHARE:
        return
    least_frames = max(FROZEN_FRAMES, round(FROZEN_SECONDS * curve.rate))
    least_metres = max(FROZEN_JUMP_METRES, FROZEN_JUMP_METRES_A_SECOND / curve.rate)
    for segment, into in _still_segments(steps, least_frames, least_metres, sensitivity):
        # A jump into the run, or its start at that of the file, shows that its first frame is
        # wrong too.
        first = segment.first + (into <= 1 and segment.first > 0)
        if not _recurs(curve, first, segment.end - 1):
            yield _finding(curve.name, "frozen", segment, first)


def _recurs(curve: Curve, first: int, last: int) -> bool:
    """Whether a value that stands still is also met elsewhere: the limit of a joint."""
    same = np.abs(curve.values - curve.values[last]).max(axis=-1) <= STILL_METRES
    return bool(same[: max(first - 1, 0)].any() or same[last + 1 :].any())


def _finding(joint: str, kind: str, segment: Segment, first: int) -> Finding:
    moves = f"then moves by {100 * segment.size:.1f} cm"
    why = f"stands still for {len(segment)} frames, {moves}"
    return Finding(joint, (first, segment.end - 1), kind, why, 0.0, confidence(segment.score))


def _still_segments(
    steps: np.ndarray, least_frames: int, least_metres: float, sensitivity: float
) -> Iterator[tuple[Segment, float]]:
    """The runs of steps (F - 1,) that stand still for at least `least_frames` and end with a jump;
    each with the score of the jump into it."""
    for start, end in runs(steps <= STILL_METRES).tolist():
        if end - start < least_frames or end == len(steps):
            continue
        before = steps[max(start - 4, 0) : max(start - 1, 0)]
        into = _score_of_jump(steps[start - 1], before, least_metres)
        score = _score_of_jump(steps[end], steps[end + 1 : end + 4], least_metres)
        if score * 2 * sensitivity > 1:
            yield Segment(start, end + 1, score, float(steps[end])), into


def _score_of_jump(step: float, neighbours: np.ndarray, least_metres: float) -> float:
    """How many times the threshold the jump out of a run that stands still is."""
    if not len(neighbours):
        return 0.0
    usual = CAUGHT_UP_RATIO * float(np.median(neighbours))
    return float(step / max(least_metres, usual, STILL_METRES))


def find_t_pose(motion: Motion) -> list[Finding]:
    """At most one finding, of kind "T-pose".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[0, 1:] = [0.0, 0.0, 0.0, 1.0]
    >>> find_t_pose(motion)
    [body: frame 0: T-pose (...
    """
    pose = leading_t_pose(motion)
    if pose is None:
        return []
    why = f"arms held out, then all joints move by {100 * pose.step:.0f} cm in a frame"
    return [Finding(BODY, (0, pose.frames - 1), "T-pose", why, 0.0, confidence(pose.score))]
