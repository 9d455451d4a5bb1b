"""What stands still: repeated frames, frozen rotations, an arm whose target stays behind, a T-pose
at the start (its rule is in `mocap.t_pose`).

Dropped frames, a sensor that stops and a pose of reference stand still until the motion jumps. A
person who stands still is never exactly still, a channel that is not used does not jump, and a
joint at its limit returns to the same value.

A freeze may also begin and end over some frames, its onset. Then the rotation's speed changes where
the onset begins, and changes back where it ends: between these two frames it is wrong, too. So it
is where inverse kinematics held a wrist at a place of the world: once the place is out of reach,
the arm is stretched and points at it, which arms of people do not do for long.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from numpy_cae.cleanup.curves import STILL_METRES, Curve, curves_of, usual_body
from numpy_cae.cleanup.finding import BODY, Finding, confidence
from numpy_cae.mocap.t_pose import leading_t_pose
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.masks import runs

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
ARMS = [f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow")]
"""ARMS: these rotations may be frozen without a jump. Knees and ankles of clean motion stand still
at their limits."""
EASED_SECONDS = 0.3
"""EASED_SECONDS: a rotation that is frozen without a jump begins and ends to stand still within
this time (s)."""
EASED_METRES = 0.04
"""EASED_METRES: in that time after it stood still it moves by more than this (m)."""
ELSEWHERE_SHARE = 0.5
"""ELSEWHERE_SHARE: where a rotation is frozen without a jump, arms stand still elsewhere for at
most this share of its frames: in an animation by keys, arms are held again and again."""
OTHERS_SHARE = 0.25
"""OTHERS_SHARE: meanwhile at most this share of the curves stands still, in the median."""
KINK_SHARE = 0.4
"""KINK_SHARE: at both ends of an onset the speed changes, in opposite ways, by changes of which the
outer one is at least this share of the inner one."""
STEADY_METRES = 1e-4
"""STEADY_METRES: the length of an arm that does not reach a place, from shoulder to wrist, changes
by at most this from frame to frame (m)."""
AIM_METRES = 1e-3
"""AIM_METRES: the line through its shoulder and wrist misses the place by at most this (m)."""
BEYOND_METRES = 0.05
"""BEYOND_METRES: the distance of its wrist from the place changes by more than this (m)."""
BESIDE_SECONDS = 3.0
"""BESIDE_SECONDS: for at most this time (s) before and after it did reach the place."""
HELD_SHARE = 0.4
"""HELD_SHARE: where more than this share of the other frames within `HELD_SECONDS` repeat a pose,
poses may be held on purpose, as in animation on twos, and repeated frames are proposed."""
HELD_SECONDS = 1.0
"""HELD_SECONDS: other frames that repeat a pose are counted within this time (s)."""
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
    still = np.zeros((2, *body.shape))  # the share of the curves, and whether one of an arm
    for curve in curves:
        steps = curve.steps()
        body += steps / len(curves)
        still[0] += (steps <= STILL_METRES) / len(curves)
        still[1] += (steps <= STILL_METRES) & (curve.is_rotation and curve.name in ARMS)
    turning = [curve for curve in curves if curve.is_rotation]
    frozen = [f for c in turning for f in _frozen(c, still, sensitivity)]
    frozen += _left_behind(motion, turning, sensitivity)
    repeated = list(_repeated(body, motion.rate, sensitivity)) if curves else []
    covered = {frame for f in repeated for frame in range(f.frames[0], f.frames[1] + 1)}
    found = repeated + [f for f in frozen if not covered.issuperset(range(*f.frames))]
    # A body that stands still from the first frame on begins so: nothing says what it did before.
    start = int(np.argmax(np.append(body, np.inf) > STILL_METRES))
    return [finding for finding in found if finding.frames[1] > start]


def _repeated(steps: np.ndarray, rate: float, sensitivity: float) -> Iterator[Finding]:
    """The runs of frames that repeat the pose of the frame before them."""
    still = steps <= STILL_METRES
    margin = round(HELD_SECONDS * rate)
    for start, end, into, score in _still_runs(steps, 1, 0.0):
        if score * 2 * sensitivity > 1:
            others = np.r_[still[max(start - margin, 0) : start], still[end : end + margin]]
            held = others.mean() > HELD_SHARE
            # A jump into the run shows that its first pose is wrong too, unless all are held.
            first = start + (held or into <= 1)
            found = _finding(BODY, (first, end), end + 1 - start, steps[end], score)
            why = f"{found.evidence}, as the frames around do: on purpose?"
            yield replace(found, status="proposed", evidence=why) if held else found


def is_held(found: list[Finding], frames: int) -> bool:
    """Whether of the frames of a motion more than `HELD_SHARE` are proposed to be repeated: its
    poses are held, and from one to the next everything jumps."""
    held = [f for f in found if (f.kind, f.status) == ("repeated", "proposed")]
    return sum(f.frames[1] + 1 - f.frames[0] for f in held) > HELD_SHARE * frames


def _frozen(curve: Curve, still: np.ndarray, sensitivity: float) -> Iterator[Finding]:
    """The runs of frames in which a rotation stands still and then jumps; or, in an arm, in which
    its values repeat exactly while other curves move, if those of arms hardly do so elsewhere."""
    steps = curve.steps()
    least_metres = max(FROZEN_JUMP_METRES, FROZEN_JUMP_METRES_A_SECOND / curve.rate)
    for start, end, into, score in _still_runs(steps, _least_frames(curve.rate), least_metres):
        score *= np.mean(steps <= STILL_METRES) < UNUSED_SHARE
        size = steps[end]
        # A jump into the run, or its start at that of the file, shows that its first frame is
        # wrong too.
        frames = start + (into <= 1 and start > 0), end
        margin = 0
        elsewhere = np.count_nonzero(still[1]) - np.count_nonzero(still[1, start:end])
        alone = start and elsewhere <= ELSEWHERE_SHARE * (end - start)
        if curve.name in ARMS and alone and np.median(still[0, start:end]) <= OTHERS_SHARE:
            margin = _longest_onset(curve.rate)
            later = np.arange(end + 1, min(end + margin + 1, len(curve.values)))
            away = curve.between(np.full(len(later), end), later)
            size = max(size, np.linalg.norm(away, axis=1).max())
            score = max(score, size / EASED_METRES)
            frames = _with_onsets(curve, start, end, frames[0])
        if score * 2 * sensitivity > 1 and not _recurs(curve, start - margin, end + margin):
            yield _finding(curve.name, frames, end + 1 - start, size, score)


def _least_frames(rate: float) -> int:
    return max(FROZEN_FRAMES, round(FROZEN_SECONDS * rate))


def _longest_onset(rate: float) -> int:
    return max(2, round(EASED_SECONDS * rate))


def _left_behind(motion: Motion, curves: list[Curve], sensitivity: float) -> Iterator[Finding]:
    """The runs of frames in which an arm of constant length points at one place of the world that
    it does not reach, and those beside them in which it does."""
    margin = round(BESIDE_SECONDS * motion.rate)
    body = usual_body(motion)
    for curve in curves:
        if curve.name not in ARMS[::2]:
            continue
        column = JOINTS.index(curve.name)
        arm = body[:, column : column + 3]
        reach = np.linalg.norm(arm[:, 2] - arm[:, 0], axis=-1)
        for start, end in runs(np.abs(np.diff(reach)) <= STEADY_METRES).tolist():
            if end - start < _least_frames(motion.rate):
                continue
            origin = max(start - margin, 0)
            near = arm[origin : end + margin]
            aims, score = _aims(near, slice(start - origin, end + 1 - origin))
            if score * 2 * sensitivity <= 1:
                continue
            ends = next(run for run in origin + runs(aims) if run[0] <= start < run[1])
            frames = _with_onsets(curve, int(ends[0]), int(ends[1]) - 1, int(ends[0]))
            for name in JOINTS[column : column + 2]:
                why = "points at one place of the world that it does not reach"
                yield Finding(name, frames, "frozen", why, 0.0, confidence(score))


def _aims(arm: np.ndarray, steady: slice) -> tuple[np.ndarray, float]:
    """The frames in which an arm (frames, 3 joints, 3) points at the place at which it points in
    the frames `steady`, and the evidence that there is one; 0 if there is none."""
    way = arm[:, 2] - arm[:, 0]
    way /= np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), STILL_METRES)
    # The place p has the least distances from the lines of these frames: Σ (I - w wᵀ) (p - s) = 0.
    across = np.eye(3) - way[:, :, None] * way[:, None]
    sums = np.einsum("fij,fj->i", across[steady], arm[steady, 0])
    place = np.linalg.lstsq(across[steady].sum(axis=0), sums)[0]
    off = np.linalg.norm(np.einsum("fij,fj->fi", across, place - arm[:, 0]), axis=-1)
    beyond = np.ptp(np.linalg.norm(place - arm[steady, 2], axis=-1))
    return off <= AIM_METRES, float(beyond / BEYOND_METRES) * (off[steady].max() <= AIM_METRES)


def _with_onsets(curve: Curve, start: int, end: int, first: int) -> tuple[int, int]:
    """The first and the last wrong frame of a rotation that stands still, or is otherwise wrong,
    from frame `start` to `end`; `first` where it does not begin slowly."""
    before = _onset(curve, start, -1)
    return start - before if before else first, end + _onset(curve, end, 1)


def _onset(curve: Curve, frame: int, way: int) -> int:
    """How many frames before (way -1) or after (1) a frame at which a rotation begins or ends to
    stand still it is wrong, too: up to the next one in which its speed changes back."""
    x = curve.continuous()
    frames = frame + way * np.arange(_longest_onset(curve.rate) + 1)
    frames = frames[(frames > 0) & (frames < len(x) - 1)]
    kinks = x[frames - 1] - 2 * x[frames] + x[frames + 1]
    back = -kinks[1:] @ kinks[0] if len(kinks) > 1 else np.zeros(1)
    return int(np.argmax(back)) if back.max() >= KINK_SHARE * np.sum(kinks[:1] ** 2) else 0


def _recurs(curve: Curve, start: int, end: int) -> bool:
    """Whether the value between two frames is also met before or after: the limit of a joint."""
    at = curve.values[(start + 1 + end) // 2]
    same = np.abs(curve.values - at).max(axis=-1) <= STILL_METRES
    return bool(same[: max(start, 0)].any() or same[end + 1 :].any())


def _finding(joint: str, frames: tuple[int, int], count: int, size: float, score: float) -> Finding:
    kind = "repeated" if joint == BODY else "frozen"
    why = f"stands still for {count} frames, then moves by {100 * size:.1f} cm"
    return Finding(joint, frames, kind, why, 0.0, confidence(score))


def _still_runs(
    steps: np.ndarray, least_frames: int, least_metres: float
) -> Iterator[tuple[int, int, float, float]]:
    """The runs of at least `least_frames` steps (F - 1,) that stand still and end before the last
    one: first, end, and the scores of the jumps into the run and out of it."""
    for start, end in runs(steps <= STILL_METRES).tolist():
        if end - start >= least_frames and end < len(steps):
            before = steps[max(start - 4, 0) : max(start - 1, 0)]
            into = _score_of_jump(steps[start - 1], before, least_metres)
            out = _score_of_jump(steps[end], steps[end + 1 : end + 4], least_metres)
            yield start, end, into, out


def _score_of_jump(step: float, neighbours: np.ndarray, least_metres: float) -> float:
    """How many times the threshold the jump into or out of a run that stands still is."""
    usual = CAUGHT_UP_RATIO * np.median(neighbours) if len(neighbours) else np.inf
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
