"""Freezes: repeated frames, frozen rotations, an arm whose target stays behind, a T-pose at the
start (its rule is in `mocap.t_pose`).

Dropped frames, a sensor that stops and a pose of reference stand still until the motion jumps. A
person who stands still is never exactly still, a channel that is not used does not jump, and a
joint at its limit returns to the same value, or is a straight knee or elbow.

A pose that is held is no damage: animations by keys hold poses, one after the other, and a clip
ends with one. Frames are dropped only if the motion before them and after them is as fast as what
it made up by the jump (`cuts.is_drop`), and a rotation is frozen only if the body turns meanwhile.

A freeze may also begin and end over some frames, its onset. Then the rotation's speed changes where
the onset begins, and changes back where it ends: between these two frames it is wrong, too.

Inverse kinematics may have held a wrist at a place of the world. Once the place is out of reach,
the arm is stretched and points at the place. Arms of people do not do so for long. Its rotations
are not constant, and they are found as frozen all the same, with their onsets.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.channels import STILL_METRES, Channel
from numpy_cae.cleanup.cuts import is_drop
from numpy_cae.cleanup.finding import Finding, confidence
from numpy_cae.cleanup.kinds import BODY, BONE, FROZEN, REPEATED, T_POSE
from numpy_cae.cleanup.view import View
from numpy_cae.mocap.t_pose import leading_t_pose
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.masks import runs

CAUGHT_UP_RATIO = 2.5
"""What stood still ends with a step of more than this times the median of the three steps after
it."""
FROZEN_SECONDS = 0.2
"""A rotation is frozen if it stands still for at least this time (s)."""
FROZEN_FRAMES = 6
"""A rotation is frozen if it stands still for at least this many steps."""
FROZEN_JUMP_METRES = 0.03
"""A frozen rotation then jumps by more than this (m)."""
FROZEN_JUMP_METRES_A_SECOND = 1.5
"""A frozen rotation then jumps faster than this (m/s)."""
ARMS = [f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow")]
"""These rotations may be frozen without a jump. Knees and ankles of clean motion stand still at
their limits."""
ONSET_SECONDS = 0.3
"""A rotation that is frozen without a jump begins and ends to stand still within this time (s)."""
ONSET_METRES = 0.04
"""Within `ONSET_SECONDS` after it stood still such a rotation moves by more than this (m)."""
ELSEWHERE_SHARE = 0.5
"""Where a rotation is frozen without a jump, arms stand still elsewhere for at most this share of
its frames: in an animation by keys, arms are held again and again."""
MOST_STILL_SHARE = 0.25
"""While a rotation is frozen without a jump, at most this share of all channels stands still, in
the median."""
KINK_SHARE = 0.4
"""At both ends of an onset the speed changes, in opposite ways, by changes of which the outer one
is at least this share of the inner one."""
STEADY_ARM_METRES = 1e-4
"""The length of an arm that does not reach a place, from shoulder to wrist, changes by at most this
from frame to frame (m)."""
AIM_METRES = 1e-3
"""The line through shoulder and wrist of such an arm misses the place by at most this (m)."""
BEYOND_METRES = 0.05
"""The distance of the wrist of such an arm from the place changes by more than this (m)."""
REACHED_SECONDS = 3.0
"""For at most this time (s) before and after such an arm did reach the place."""
HELD_SHARE = 0.4
"""Where more than this share of the frames within `HELD_SECONDS` around repeat a pose, poses may be
held on purpose, as in animation on twos, and repeated frames are proposed."""
HELD_SECONDS = 1.0
"""Frames around that repeat a pose are counted within this time (s)."""
REPEATED_METRES = 5e-4
"""Frames that repeat a pose are found only if the channels then move by more than this (m), in the
mean: less is printed as 0.0 cm."""
STRAIGHT_DEGREES = 1.0
"""A knee or an elbow that is bent by less than this (°) is at its limit, and not frozen."""
KNEES = ("left_knee", "right_knee")
"""These are straight at their limit."""
ELBOWS = ("left_elbow", "right_elbow")
"""These are straight at their limit, or if a marker is missing; then they jump to it or from it."""
USUAL_SHARE = 0.95
"""A step of a channel is usual up to this quantile of the steps in which it moves."""
UNUSUAL_RATIO = 1.5
"""An elbow does not come to its limit, or leave it, by a step of more than this times the usual
ones: of forearms in the rest pose for a while the ratio is 1.6 to 136 in 44 of 48, with onsets of
one to four frames at 30 a second, in walks, runs, waves and punches of data_synth."""
UNUSED_SHARE = 0.75
"""A rotation that stands still for more than this share of the file is not frozen, but not used."""


class StillRun(NamedTuple):
    """A run of steps that stand still: its first step, its end, and the scores of the jumps into it
    and out of it."""

    first: int
    end: int
    score_in: float
    score_out: float


class StillShares(NamedTuple):
    """For each step of a motion (frames - 1,) the share of the channels that stand still, how many
    of the rotations of the whole body do, and how many of those of arms."""

    of_channels: np.ndarray
    of_body: np.ndarray
    of_arms: np.ndarray


def find_freezes(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """Findings of the kinds "repeated" (the whole body) and "frozen" (one rotation).

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("run", 0, seconds=2.0, rate=30.0).motion
    >>> find_freezes(View(motion.at(np.r_[:30, [29] * 5, 35:60])))
    [body: frames 30 to 34: repeated (...
    """
    channels = [channel for channel in view.channels if channel.channel != BONE]
    mean_steps = np.zeros(max(len(view) - 1, 0))
    still = StillShares(*np.zeros((3, len(mean_steps))))
    joints = [channel for channel in channels if channel.is_rotation and channel.name in JOINTS]
    for channel in channels:
        steps = channel.steps()
        is_still = steps <= STILL_METRES
        mean_steps += steps / len(channels)
        still.of_channels[:] += is_still / len(channels)
        if channel.is_rotation and channel.is_root:
            still.of_body[:] += is_still
        if channel in joints and channel.name in ARMS:
            still.of_arms[:] += is_still
    rotations = [channel for channel in channels if channel.is_rotation]
    repeated: list[Finding] = []
    if channels:
        repeated = list(_find_repeated(mean_steps, view, sensitivity))
    frozen: list[Finding] = []
    for channel in rotations:
        frozen += _find_frozen(view, channel, still, sensitivity)
    frozen += _find_left_behind(view, rotations, sensitivity)
    covered: set[int] = set()
    for finding in repeated:
        covered.update(range(finding.frames[0], finding.frames[1] + 1))
    alone = [finding for finding in frozen if not covered.issuperset(range(*finding.frames))]
    # A body that stands still from the first frame on begins so: nothing says what it did before.
    start = int(np.argmax(np.append(mean_steps, np.inf) > STILL_METRES))
    return [finding for finding in repeated + alone if finding.frames[1] > start]


def _find_repeated(steps: np.ndarray, view: View, sensitivity: float) -> Iterator[Finding]:
    """The runs of frames that repeat the pose of the frame before them."""
    is_still = steps <= STILL_METRES
    margin = view.frames(HELD_SECONDS)
    for run in _still_runs(steps, 1, REPEATED_METRES):
        if run.score_out * 2 * sensitivity <= 1:
            continue
        start = run.first
        end = run.end
        around = np.r_[is_still[max(start - margin, 0) : start], is_still[end : end + margin]]
        held_on_purpose = bool(around.mean() > HELD_SHARE)
        if not held_on_purpose and not _is_drop(view, start, end):
            continue
        # A jump into the run shows that its first pose is wrong too, unless all are held.
        first = start + (held_on_purpose or run.score_in <= 1)
        evidence = _evidence(end + 1 - start, steps[end])
        status = "repaired"
        if held_on_purpose:
            evidence = f"{evidence}, as the frames around do: on purpose?"
            status = "proposed"
        sure = confidence(run.score_out)
        yield Finding(BODY, (first, end), REPEATED.name, evidence, 0.0, sure, status)


def _is_drop(view: View, start: int, end: int) -> bool:
    """Whether frames were dropped where a pose is repeated from frame `start` to `end`."""
    body = view.body
    jump = body[end + 1] - body[end]
    speed_before = body[start] - body[max(start - 1, 0)]
    speed_after = body[min(end + 2, len(body) - 1)] - body[end + 1]
    return is_drop(end + 1 - start, view.rate, jump, speed_before, speed_after)


def is_held(findings: list[Finding], frames: int) -> bool:
    """Whether of the frames of a motion more than `HELD_SHARE` are proposed to be repeated: its
    poses are held, and from one to the next everything jumps."""
    held = 0
    for finding in findings:
        if finding.row is REPEATED and finding.status == "proposed":
            held += finding.frames[1] + 1 - finding.frames[0]
    return held > HELD_SHARE * frames


def _find_frozen(
    view: View, channel: Channel, still: StillShares, sensitivity: float
) -> Iterator[Finding]:
    """The runs of frames in which a rotation stands still while the other joints move, and then
    jumps; or, in an arm, in which its values repeat exactly while other channels move, if those of
    arms hardly do so elsewhere."""
    steps = channel.steps()
    least_metres = max(FROZEN_JUMP_METRES, FROZEN_JUMP_METRES_A_SECOND / channel.rate)
    is_used = np.mean(steps <= STILL_METRES) < UNUSED_SHARE
    for run in _still_runs(steps, _least_frames(channel.rate), least_metres):
        start = run.first
        end = run.end
        if _is_straight(view, channel, start, end):
            continue
        body_turns = np.median(still.of_body[start:end]) == 0
        score = run.score_out if is_used and body_turns else 0.0
        size = steps[end]
        # A jump into the run, or its start at that of the file, shows that its first frame is
        # wrong too.
        first = start + (run.score_in <= 1 and start > 0)
        frames = (first, end)
        margin = 0
        if channel.name in ARMS and _stands_alone(still, start, end):
            margin = _longest_onset(channel.rate)
            later = np.arange(end + 1, min(end + margin + 1, len(channel.values)))
            away = channel.between(np.full(len(later), end), later)
            size = max(size, np.linalg.norm(away, axis=1).max())
            score = max(score, size / ONSET_METRES)
            frames = _with_onsets(channel, start, end, first)
        if score * 2 * sensitivity > 1 and not _recurs(channel, start - margin, end + margin):
            evidence = _evidence(end + 1 - start, size)
            yield Finding(channel.name, frames, FROZEN.name, evidence, 0.0, confidence(score))


def _is_straight(view: View, channel: Channel, start: int, end: int) -> bool:
    """Whether a rotation that stands still between two frames is that of a straight knee or elbow:
    the limit of the joint."""
    if channel.name not in KNEES + ELBOWS:
        return False
    column = JOINTS.index(channel.name)
    limb = view.body[(start + 1 + end) // 2, column - 1 : column + 2]
    bones = np.diff(limb, axis=0)
    lengths = np.linalg.norm(bones, axis=1)
    cosine = bones[0] @ bones[1] / max(lengths[0] * lengths[1], STILL_METRES)
    is_straight = bool(cosine > np.cos(np.radians(STRAIGHT_DEGREES)))
    return is_straight and not (channel.name in ELBOWS and _is_forced(channel, start, end))


def _is_forced(channel: Channel, start: int, end: int) -> bool:
    """Whether a rotation comes to where it stands still from frame `start` to `end`, or leaves it,
    by steps that are longer than its usual ones."""
    steps = channel.steps()
    margin = _longest_onset(channel.rate)
    at_ends = np.r_[steps[max(start - margin, 0) : start], steps[end : end + margin]]
    rest = np.r_[steps[: max(start - margin, 0)], steps[end + margin :]]
    moving = rest[rest > STILL_METRES]
    usual = np.quantile(moving, USUAL_SHARE) if len(moving) else 0.0
    return bool(at_ends.max(initial=0.0) > UNUSUAL_RATIO * usual)


def _stands_alone(still: StillShares, start: int, end: int) -> bool:
    """Whether other channels move while one stands still in a run of steps, and arms hardly stand
    still elsewhere."""
    elsewhere = np.count_nonzero(still.of_arms) - np.count_nonzero(still.of_arms[start:end])
    if not start or elsewhere > ELSEWHERE_SHARE * (end - start):
        return False
    return bool(np.median(still.of_channels[start:end]) <= MOST_STILL_SHARE)


def _least_frames(rate: float) -> int:
    return max(FROZEN_FRAMES, round(FROZEN_SECONDS * rate))


def _longest_onset(rate: float) -> int:
    return max(2, round(ONSET_SECONDS * rate))


def _find_left_behind(
    view: View, rotations: list[Channel], sensitivity: float
) -> Iterator[Finding]:
    """The runs of frames in which an arm of constant length points at one place of the world that
    it does not reach, and those beside them in which it does."""
    margin = view.frames(REACHED_SECONDS)
    for channel in rotations:
        if channel.name not in ARMS[::2]:
            continue
        column = JOINTS.index(channel.name)
        arm = view.body[:, column : column + 3]
        reach = np.linalg.norm(arm[:, 2] - arm[:, 0], axis=-1)
        for start, end in runs(np.abs(np.diff(reach)) <= STEADY_ARM_METRES).tolist():
            if end - start < _least_frames(view.rate):
                continue
            origin = max(start - margin, 0)
            near = arm[origin : end + margin]
            aims, score = _aims(near, slice(start - origin, end + 1 - origin))
            if score * 2 * sensitivity <= 1:
                continue
            ends = next(run for run in origin + runs(aims) if run[0] <= start < run[1])
            frames = _with_onsets(channel, int(ends[0]), int(ends[1]) - 1, int(ends[0]))
            evidence = "points at one place of the world that it does not reach"
            for name in JOINTS[column : column + 2]:
                yield Finding(name, frames, FROZEN.name, evidence, 0.0, confidence(score))


def _aims(arm: np.ndarray, steady: slice) -> tuple[np.ndarray, float]:
    """The frames in which an arm (frames, 3 joints, 3) points at the place at which it points in
    the frames `steady`, and the evidence that there is one; 0 if there is none."""
    way = arm[:, 2] - arm[:, 0]
    way /= np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), STILL_METRES)
    # The place p has the least distances from the lines of these frames: Σ (I - w wᵀ) (p - s) = 0.
    across = np.eye(3) - way[:, :, None] * way[:, None]
    sums = np.einsum("fij,fj->i", across[steady], arm[steady, 0])
    place = np.linalg.lstsq(across[steady].sum(axis=0), sums, rcond=None)[0]
    off = np.linalg.norm(np.einsum("fij,fj->fi", across, place - arm[:, 0]), axis=-1)
    score = 0.0
    if off[steady].max() <= AIM_METRES:
        score = float(np.ptp(np.linalg.norm(place - arm[steady, 2], axis=-1)) / BEYOND_METRES)
    return off <= AIM_METRES, score


def _with_onsets(channel: Channel, start: int, end: int, first: int) -> tuple[int, int]:
    """The first and the last wrong frame of a rotation that stands still, or is otherwise wrong,
    from frame `start` to `end`; `first` where it does not begin slowly."""
    before = _onset(channel, start, -1)
    return start - before if before else first, end + _onset(channel, end, 1)


def _onset(channel: Channel, frame: int, direction: int) -> int:
    """How many frames before (direction -1) or after (1) a frame at which a rotation begins or ends
    to stand still it is wrong, too: up to the next one in which its speed changes back."""
    x = channel.continuous()
    frames = frame + direction * np.arange(_longest_onset(channel.rate) + 1)
    frames = frames[(frames > 0) & (frames < len(x) - 1)]
    kinks = x[frames - 1] - 2 * x[frames] + x[frames + 1]
    back = -kinks[1:] @ kinks[0] if len(kinks) > 1 else np.zeros(1)
    return int(np.argmax(back)) if back.max() >= KINK_SHARE * np.sum(kinks[:1] ** 2) else 0


def _recurs(channel: Channel, start: int, end: int) -> bool:
    """Whether the value between two frames is also met before or after: the limit of a joint."""
    value = channel.values[(start + 1 + end) // 2]
    is_same = np.abs(channel.values - value).max(axis=-1) <= STILL_METRES
    return bool(is_same[: max(start, 0)].any() or is_same[end + 1 :].any())


def _evidence(frames: int, metres: float) -> str:
    return f"stands still for {frames} frames, then moves by {100 * metres:.1f} cm"


def _still_runs(steps: np.ndarray, least_frames: int, least_metres: float) -> Iterator[StillRun]:
    """The runs of at least `least_frames` steps (F - 1,) that end before the last one."""
    for start, end in runs(steps <= STILL_METRES).tolist():
        if end - start >= least_frames and end < len(steps):
            before = steps[max(start - 4, 0) : max(start - 1, 0)]
            score_in = _score_of_jump(steps[start - 1], before, least_metres)
            score_out = _score_of_jump(steps[end], steps[end + 1 : end + 4], least_metres)
            yield StillRun(start, end, score_in, score_out)


def _score_of_jump(step: float, neighbours: np.ndarray, least_metres: float) -> float:
    """How many times the threshold the jump into or out of a run that stands still is."""
    usual = CAUGHT_UP_RATIO * np.median(neighbours) if len(neighbours) else np.inf
    return float(step / max(least_metres, usual, STILL_METRES))


def find_t_pose(motion: Motion, view: View | None = None) -> list[Finding]:
    """At most one finding, of kind "T-pose"; a view of the motion spares computing its body.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[0, 1:] = [0.0, 0.0, 0.0, 1.0]
    >>> find_t_pose(motion)
    [body: frame 0: T-pose (...
    """
    body = None
    if view is not None and view.is_person:  # a pose of reference need not be a person's
        body = view.body * view.size
    pose = leading_t_pose(motion, body)
    if pose is None:
        return []
    evidence = f"arms held out, then all joints move by {100 * pose.step:.0f} cm in a frame"
    last = pose.frames - 1
    return [Finding(BODY, (0, last), T_POSE.name, evidence, 0.0, confidence(pose.score))]
