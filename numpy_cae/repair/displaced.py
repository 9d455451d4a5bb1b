"""What is displaced between a jump and the jump back, or from a jump on.

A rotation that is turned by a constant turn Q, in its own frame or in its parent's, jumps by Q and
back by Q⁻¹, and a root that is moved by D jumps by D and back by -D:

    R'_t = R_t Q    or    R'_t = Q R_t    or    p'_t = p_t + D,    a < t ≤ b

Such a displacement is undone: the values next to each jump are moved to where the motion outside
continues, and those between the jumps by a displacement interpolated between these two. A
rotation by half a turn that does not come back is undone up to the end of the file, or to its start
if that has a few frames only; that of a limb is proposed only, since either half may be right.
Where a root does not come back, the shorter part of the file is moved to where the longer one
leads, the frames before the jump or those from it on, at the height where it is unless most of the
jump is upwards or downwards.

If two opposite jumps do not undo each other, the rotations between them are those of another
motion: they are interpolated (`holes`), unless the frames outside may be those of another motion.

A spike, a rotation or a place that jumps away and back within a few frames, is found otherwise. A
run of n frames is compared with the cubic through the two frames before it and the two after it.
Its deviation is the smaller one of its first and its last frame: that of a run which is longer than
the spike, or beside it, is nearly 0. Of runs that touch each other, the one with the largest
deviation is the spike. It is removed and the rest is searched again, as a spike also distorts the
cubics beside it. The joints below must deviate from their cubics too: several rotations may jump
together and cancel each other, so that the body does not move.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from numpy_cae.motion.hole_curves import over_holes, rejoined, rotations_over_holes
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import angle, inverse, product, rotate
from numpy_cae.repair.curves import (
    FASTEST_DEGREES_A_SECOND,
    Curve,
    Segment,
    body_size,
    curves_of,
    jumps_of,
    least_jump,
    local_median,
)
from numpy_cae.repair.finding import Finding, confidence
from numpy_cae.repair.interpolated import interpolate_channels

CLOSING_SHARE = 0.3
"""CLOSING_SHARE: two jumps undo each other if what is left is at most this share of the smaller
one."""
CALM_SHARE = 0.35
"""CALM_SHARE: two jumps undo each other if no step between them is longer than this share of the
smaller one."""
LEAST_TURN_DEGREES = 20.0
"""LEAST_TURN_DEGREES: a jump of a rotation counts if it is larger than this (°)."""
LONGEST_SECONDS = 1.5
"""LONGEST_SECONDS: rotations are interpolated between two jumps that are at most this far apart
(s)."""
LATER_JUMPS = 6
"""LATER_JUMPS: a segment ends at one of this many jumps after the one at which it begins."""
OPPOSITE_COSINE = -0.5
"""OPPOSITE_COSINE: two jumps whose directions have a cosine below this lead back; those of the root
do not count, since a body that turns and turns back may kick."""
PREFERRED = ("spike", "undone", "interpolated", "to the end")
"""PREFERRED: what a segment that may be several of these is taken for; spikes are left to
`find_spikes`."""
HALF_TURN_DEGREES = 150.0
"""HALF_TURN_DEGREES: a rotation that jumps by more than this (°) and does not come back is
undone."""
LONGEST_SPIKE_SECONDS = 0.1
"""LONGEST_SPIKE_SECONDS: a spike lasts at most this time (s), or a frame."""
LEAST_ACCELERATION = 60.0
"""LEAST_ACCELERATION: a spike deviates by more than the shortest jump (`least_jump`), and by more
than this acceleration (m/s²) moves a joint in the time of a frame: a hand or foot that strikes
reaches it."""
NOISE_RATIO = 9.0
"""NOISE_RATIO: a spike deviates by more than this times the noise, which is the median over a
second of the deviations of single frames."""
NEIGHBOUR_RATIO = 1.5
"""NEIGHBOUR_RATIO: a spike deviates by more than this times the sum of the larger step just before
or after it and the first step within it."""
RETURN_SHARE = 0.5
"""RETURN_SHARE: the steps to a spike and from it are both longer than this share of its deviation:
it goes there and back. Before a joint that jumps and stays, one of them is short."""
SAME_WAY_COSINE = 0.5
"""SAME_WAY_COSINE: a run is no spike if the cosine of the angle between the steps to it and from it
is at least this: the joint passes through, as the elbow of a runner at 24 frames a second does."""
SPIKE_ROUNDS = 4
"""SPIKE_ROUNDS: spikes are removed and looked for again at most this often."""


def find_displaced(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """Findings of the kinds "turned", "displaced", "length" and "root elsewhere".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[40:, 0] += [0.5, 0.0, 0.0]
    >>> find_displaced(motion)
    [hips: frames 40 to 59: root elsewhere (moves by 51.6 cm in a frame): confidence ...

    A first frame that stands elsewhere is moved to the rest, not the rest to it:

    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[0, 0] += [0.5, 0.0, 0.0]
    >>> find_displaced(motion)
    [hips: frame 0: root elsewhere (moves by 49.4 cm in a frame): confidence ...
    >>> mended = mend_displaced(motion, find_displaced(motion))
    >>> bool(np.ptp(mended.translations[:2, 0], axis=0).max() < 0.05)
    True
    """
    return [
        _finding(curve, segment, kind)
        for curve in curves_of(motion)
        for segment, kind in _classified(curve, sensitivity)
        if kind != "spike" and (kind != "interpolated" or _all_jump(motion, curve, segment))
    ]


def mend_displaced(motion: Motion, findings: list[Finding]) -> Motion:
    """The motion with displacements undone, and what is "displaced" interpolated."""
    changed: dict[str, Any] = {}  # rotations and translations
    for curve in curves_of(motion):
        kind = "turned" if curve.is_rotation else curve.spike_kind
        name = "rotations" if curve.is_rotation else "translations"
        for finding in findings:
            if (finding.joint, finding.kind) == (curve.name, kind):
                if name not in changed:  # an hour of rotations takes 0.4 GB: one copy for all
                    changed[name] = getattr(motion, name).copy()
                changed[name][finding.stretch, curve.joint] = _undone(curve, finding.stretch)
                curve = replace(curve, values=changed[name][:, curve.joint])
    undone = replace(motion, **changed)
    return interpolate_channels(undone, [f for f in findings if f.kind == "displaced"])


def _classified(curve: Curve, sensitivity: float) -> Iterator[tuple[Segment, str]]:
    """The segments of a curve that are displaced, each with one of `PREFERRED`; none overlaps
    another, but for those up to the end of the curve."""
    jumps = jumps_of(curve, sensitivity)
    frames = [frame for frame, _ in jumps]
    end = 0
    for number, (first, score) in enumerate(jumps):
        if first <= end:
            continue
        later = jumps[number + 1 : number + 1 + LATER_JUMPS]
        segments = [Segment(first, stop, min(score, other)) for stop, other in later]
        if not later or curve.spike_kind == "root elsewhere":
            segments.append(Segment(first, len(curve.values), score))
        by_kind: dict[str, Segment] = {}
        for segment in segments:
            for kind in _kinds(curve, segment, frames):
                by_kind.setdefault(kind, segment)
        best = next((kind for kind in PREFERRED if kind in by_kind), None)
        if best is not None:
            chosen = by_kind[best]
            end = first if chosen.end == len(curve.values) else chosen.end
            yield chosen, best


def _kinds(curve: Curve, segment: Segment, jumps: list[int]) -> Iterator[str]:
    """What a segment may be: a "spike", a displacement to be "undone" up to the jump back or "to
    the end", or values of another motion to be "interpolated"."""
    if segment.end == len(curve.values):
        # A hand or a thumb may be turned by half a turn: a rig's limits are those of its limbs.
        degrees = max(HALF_TURN_DEGREES, FASTEST_DEGREES_A_SECOND / curve.rate)
        large = _size(curve, segment.first) > _least(curve, degrees)
        if large and curve.name in JOINTS:
            yield "to the end"
        return
    returns = _returns(curve, segment)
    if returns and len(segment) <= longest_spike(curve.rate):
        yield "spike"
    if _closes(curve, segment):
        yield "undone"
    if returns and _is_between(curve, segment, jumps):
        yield "interpolated"


def _is_between(curve: Curve, segment: Segment, jumps: list[int]) -> bool:
    """Whether there is motion before and after a segment, without other jumps for as long as it
    lasts: else the frames outside may be the wrong ones."""
    few = longest_spike(curve.rate)
    first, end = segment.first, segment.end
    around = {*range(first - len(segment), first), *range(end + 1, end + len(segment) + 1)}
    return few < first and end < len(curve.values) - few and around.isdisjoint(jumps)


def _all_jump(motion: Motion, curve: Curve, segment: Segment) -> bool:
    """Whether all joints that a rotation carries jump with it at one end of a segment or the other.
    If the knee jumps and the ankle does not, the leg is turned about the line from the hip to the
    ankle, and to interpolate the hip would lose where the ankle is."""
    jumps = []
    for frame in (segment.first, segment.end):
        places = _carried(motion.at(slice(frame - 2, frame + 2)), curve) / body_size(motion)
        steps = np.diff(places, axis=0)
        jumps.append(np.linalg.norm(steps[1] - (steps[0] + steps[2]) / 2, axis=-1))
    return bool(np.all(np.maximum(*jumps) > least_jump(curve.rate) / 2))


def _finding(curve: Curve, segment: Segment, kind: str) -> Finding:
    """The finding of a segment that is one of `PREFERRED`."""
    first, end = segment.first, segment.end
    to_the_end = end == len(curve.values)
    of_rotation = "displaced" if kind == "interpolated" else "turned"
    kind = of_rotation if curve.is_rotation else curve.spike_kind
    amount = curve.amount(_size(curve, first))
    few = longest_spike(curve.rate) if curve.is_rotation else end / 2
    if to_the_end and first <= few:
        first, end = 0, first
    moves = "turns" if curve.is_rotation else "moves"
    back = "" if to_the_end else " and back"
    why = f"{moves} by {amount} in a frame{back}"
    # Which half of a limb's motion is turned is not certain: either may be a pose of people.
    status = "proposed" if to_the_end and curve.is_rotation and not curve.is_root else "repaired"
    frames = (first, end - 1)
    return Finding(curve.name, frames, kind, why, 0.0, confidence(segment.score), status)


def _size(curve: Curve, frame: int) -> float:
    """The length of the step to a frame, metres."""
    return float(np.linalg.norm(curve.between(np.array([frame - 1]), np.array([frame]))))


def _least(curve: Curve, degrees: float = LEAST_TURN_DEGREES) -> float:
    """The least size of a jump that counts, metres."""
    return np.radians(degrees) * curve.lever if curve.is_rotation else least_jump(curve.rate)


def _closes(curve: Curve, segment: Segment) -> bool:
    """Whether the step out of a segment undoes the step into it, and these are large."""
    size = min(_size(curve, segment.first), _size(curve, segment.end))
    if size <= _least(curve) or min(_remaining(curve, segment)) >= CLOSING_SHARE * size:
        return False
    within = curve.steps(slice(segment.first, segment.end)).max(initial=0.0)
    return bool(within < CALM_SHARE * size)


def _returns(curve: Curve, segment: Segment) -> bool:
    """Whether values are others for a short time only: after it, they are nearly what they were
    before, or the two steps are opposite."""
    before, after = np.array([segment.first - 1]), np.array([segment.end])
    step_in = curve.between(before, before + 1)[0]
    step_out = curve.between(after - 1, after)[0]
    away, back = float(np.linalg.norm(step_in)), float(np.linalg.norm(step_out))
    left = float(np.linalg.norm(curve.between(before, after)))
    smaller = min(away, back)
    if len(segment) > LONGEST_SECONDS * curve.rate or smaller <= _least(curve):
        return False
    opposite = step_in @ step_out < OPPOSITE_COSINE * away * back and max(away, back) < 2 * smaller
    return bool((opposite and not curve.is_root) or left < CLOSING_SHARE * smaller)


def _remaining(curve: Curve, segment: Segment) -> list[float]:
    """What is left of the two jumps, in metres: in the joint's own frame, and for rotations in its
    parent's (the inverse rotations)."""
    x = curve.values[[segment.first - 1, segment.first, segment.end - 1, segment.end]]
    if not curve.is_rotation:
        return [curve.lever * float(np.linalg.norm(x[1] - x[0] + x[3] - x[2]))]
    left = []
    for q in (x, inverse(x)):
        jump_in, jump_out = product(inverse(q[0]), q[1]), product(inverse(q[2]), q[3])
        left.append(curve.lever * float(angle(product(jump_in, jump_out))))
    return left


def _undone(curve: Curve, frames: slice) -> np.ndarray:
    """The values of some frames with their displacement undone."""
    x = curve.values
    first, end = frames.start, frames.stop
    inside = x[first:end]
    if curve.is_rotation:
        has_ends = 0 < first and end < len(x)
        if has_ends and np.argmin(_remaining(curve, Segment(first, end, 0.0))) == 1:
            return inverse(rejoined(inverse(x), first, end))
        return rejoined(x, first, end)
    corrections = []
    if first:
        corrections.append(2 * x[first - 1] - x[max(first - 2, 0)] - inside[0])
    if end < len(x):
        corrections.append(2 * x[end] - x[min(end + 1, len(x) - 1)] - inside[-1])
    share = np.linspace(0.0, 1.0, len(inside))[:, None]
    correction = (1 - share) * corrections[0] + share * corrections[-1]
    step = np.abs(corrections[0])
    if curve.is_root and len(corrections) == 1 and step[1] < step.max() / 2:
        correction[:, 1] = 0.0  # the path goes on elsewhere, on the same floor
    return inside + correction


def find_spikes(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """The spikes of each joint of the rig; those of bones have kind "length", of the root's place
    "root elsewhere".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> find_spikes(motion)
    [left_elbow: frame 30: spike (...]
    """
    found = []
    for curve in curves_of(motion):
        for _ in range(SPIKE_ROUNDS):
            spikes = _spikes(motion, curve, sensitivity)
            for spike in spikes:
                why = f"{curve.amount(spike.size)} from the frames before and after"
                frames = (spike.first, spike.end - 1)
                sure = confidence(spike.score)
                found.append(Finding(curve.name, frames, curve.spike_kind, why, 0.0, sure))
            if not spikes:
                break
            curve = _interpolated(curve, spikes)
    return list(dict.fromkeys(found))  # a replaced frame may deviate again


def longest_spike(rate: float) -> int:
    """The frames of the longest spike at a rate."""
    return max(1, round(LONGEST_SPIKE_SECONDS * rate))


def _least_spike(rate: float) -> float:
    """The least deviation of a spike at a rate, metres."""
    return max(least_jump(rate), LEAST_ACCELERATION / rate**2)


def _spikes(motion: Motion, curve: Curve, sensitivity: float) -> list[Segment]:
    """Of the runs of a curve that may be spikes, those with the largest deviations, no two of which
    touch each other, and of these those that move the body."""
    candidates = _candidates(curve, sensitivity)
    candidates.sort(key=lambda run: (run.size, run.score, run), reverse=True)
    taken = np.zeros(len(curve.values), bool)
    spikes = []
    for run in candidates:
        if not taken[run.first - 1 : run.end + 1].any():
            taken[run.first : run.end] = True
            spikes.append(run)
    return [run for run in spikes if _moves(motion, curve, run, sensitivity)]


def _candidates(curve: Curve, sensitivity: float) -> list[Segment]:
    """The runs of a curve that deviate from the frames around them more than noise and the motion
    do."""
    steps = curve.steps()  # steps[t] is from frame t to frame t + 1
    # Most curves have no step that is long enough, and need no median.
    least = _least_spike(curve.rate)
    if len(steps) < 4 or steps.max() * 4 * sensitivity <= least:
        return []
    level = np.maximum(least, NOISE_RATIO * local_median(curve.roughness(), curve.rate))
    values = curve.continuous()
    runs = []
    for length in range(1, longest_spike(curve.rate) + 1):
        first = np.arange(2, len(values) - length - 1)  # with two frames before and after the run
        # The step to the first frame and the one from the last are at least half of the deviation.
        smaller_step = np.minimum(steps[first - 1], steps[first + length - 1])
        first = first[smaller_step > level[first] / (4 * sensitivity)]
        end = first + length
        step_in, step_out = values[first] - values[first - 1], values[end] - values[end - 1]
        cosine = np.sum(step_in * step_out, axis=-1)
        back = cosine < SAME_WAY_COSINE * steps[first - 1] * steps[end - 1]
        first, end = first[back], end[back]
        size = _deviation(values, first, length)
        beside = np.maximum(steps[first - 2], steps[end])
        within = steps[first] if length > 1 else 0.0
        score = size / np.maximum(level[first], NEIGHBOUR_RATIO * (beside + within))
        returns = np.minimum(steps[first - 1], steps[end - 1]) > RETURN_SHARE * size
        for i in np.flatnonzero(returns & (score > 1 / (2 * sensitivity))):
            runs.append(Segment(int(first[i]), int(end[i]), float(score[i]), float(size[i])))
    return runs


def _moves(motion: Motion, curve: Curve, spike: Segment, sensitivity: float) -> bool:
    """Whether a point that the joint carries leaves its own cubic with a spike, too."""
    around = motion.at(slice(spike.first - 2, spike.end + 2))
    positions = _carried(around, curve) / body_size(motion)
    off = _deviation(positions, np.array([2]), len(spike))[0]
    beside = np.linalg.norm(positions[[1, -1]] - positions[[0, -2]], axis=-1).max(axis=0)
    least = np.maximum(_least_spike(motion.rate), NEIGHBOUR_RATIO * beside)
    return not len(off) or bool((off * 2 * sensitivity > least).any())


def _carried(motion: Motion, curve: Curve) -> np.ndarray:
    """The places of the joints that a curve moves, or of the end of its bone where there is none,
    (frames, N, 3)."""
    skeleton = motion.skeleton
    joints = range(len(skeleton.names))
    below = [joint for joint in joints if curve.joint in skeleton.path(joint)[curve.is_rotation :]]
    end = skeleton.end_sites.get(curve.joint)
    if below or end is None:
        return motion.positions(below)
    positions, rotations = motion.forward_kinematics([curve.joint])
    place = positions[:, curve.joint] + rotate(rotations[:, curve.joint], np.asarray(end))
    return place[:, None]


def _deviation(values: np.ndarray, first: np.ndarray, length: int) -> np.ndarray:
    """How far runs of values (F, …, C) that begin at the frames `first` (N,) are from their cubics,
    (N, …) in metres."""
    deviations = []
    times = np.array([-1, 0, length + 1, length + 2])  # of the frames of a cubic; the run is from 1
    for at in (1, length):
        off = values[first - 1 + at].copy()
        for time in times:
            others = times[times != time]
            off -= np.prod((at - others) / (time - others)) * values[first - 1 + time]
        deviations.append(np.linalg.norm(off, axis=-1))
    return np.minimum(*deviations)


def _interpolated(curve: Curve, segments: Sequence[Segment]) -> Curve:
    """A curve interpolated over segments."""
    missing = np.zeros((len(curve.values), 1), bool)
    missing[[frame for run in segments for frame in range(run.first, run.end)]] = True
    over = rotations_over_holes if curve.is_rotation else over_holes
    return replace(curve, values=over(curve.values[:, None], missing, curve.rate)[:, 0])
