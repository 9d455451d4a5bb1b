"""What is displaced between a jump and the jump back, or from a jump on.

A rotation that is turned by a constant turn Q, in its own frame or in its parent's, jumps by Q and
back by Q⁻¹, and a root that is moved by D jumps by D and back by -D:

    R'_t = R_t Q    or    R'_t = Q R_t    or    p'_t = p_t + D,    a < t ≤ b

Such a displacement is undone: the values next to each jump are moved to where the motion outside
continues, and those between the jumps by a displacement interpolated between these two. A
rotation by half a turn that does not come back is undone up to the end of the file, or to its start
if that has a few frames only; that of a limb is proposed only, since either half may be right.
Where a root does not come back, the shorter part of the file is moved to where the longer one
leads, the frames before the jump or those from it on; at the height where it is if its feet would
leave the floor of the other part.

If two opposite jumps do not undo each other, the rotations between them are those of another
motion: they are interpolated (`holes`), unless the frames outside may be those of another motion.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from numpy_cae.cleanup import curves
from numpy_cae.cleanup.curves import Curve, Segment, body_size, curves_of, least_jump, local_median
from numpy_cae.cleanup.finding import Finding, confidence
from numpy_cae.cleanup.interpolated import TRANSLATION_KINDS, interpolate_channels
from numpy_cae.cleanup.spikes import carried, longest_spike
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.contacts import floor_height
from numpy_cae.motion.hole_curves import join_rotations
from numpy_cae.motion.quaternions import angle, inverse, product

JUMP_TO_NEIGHBOURS_RATIO = 3.0
"""JUMP_TO_NEIGHBOURS_RATIO: a step is a jump only if it is longer than this times the steps before
and after it."""
JUMP_TO_USUAL_RATIO = 8.0
"""JUMP_TO_USUAL_RATIO: a step is a jump only if it is longer than this times the median, over a
second, of the change from step to step."""
FASTEST_DEGREES_A_SECOND = 1500.0
"""FASTEST_DEGREES_A_SECOND: the whole body does not turn faster than this (° a second)."""
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
    """The motion with displacements undone; what is "displaced" is interpolated, and places that
    are others for as short a time as a spike."""
    moved = [f for f in findings if f.kind in TRANSLATION_KINDS and _is_short(f, motion)]
    interpolated = [f for f in findings if f.kind == "displaced"] + moved
    changed: dict[str, Any] = {}  # rotations and translations
    for curve in curves_of(motion):
        kind = "turned" if curve.is_rotation else curve.spike_kind
        name = "rotations" if curve.is_rotation else "translations"
        for finding in findings:
            if (finding.joint, finding.kind) == (curve.name, kind) and finding not in moved:
                if name not in changed:  # an hour of rotations takes 0.4 GB: one copy for all
                    changed[name] = getattr(motion, name).copy()
                values = _undone(curve, finding.stretch)
                if _leaves_floor(motion, curve, finding.stretch, values):
                    values[:, 1] = curve.values[finding.stretch, 1]
                changed[name][finding.stretch, curve.joint] = values
                curve = replace(curve, values=changed[name][:, curve.joint])
    undone = replace(motion, **changed)
    return interpolate_channels(undone, interpolated)


def _is_short(finding: Finding, motion: Motion) -> bool:
    """Whether a finding has frames before and after it and is no longer than a spike."""
    first, end = finding.stretch.start, finding.stretch.stop
    return 0 < first and end < len(motion) and end - first <= longest_spike(motion.rate)


def _classified(curve: Curve, sensitivity: float) -> Iterator[tuple[Segment, str]]:
    """The segments of a curve that are displaced, each with one of `PREFERRED`; none overlaps
    another, but for those up to the end of the curve."""
    jumps = _jumps_of(curve, sensitivity)
    frames = np.array([frame for frame, _ in jumps], int)
    lengths = np.linalg.norm(curve.between(frames - 1, frames), axis=1)
    sizes = dict(zip(frames.tolist(), lengths.tolist(), strict=True))
    end = 0
    for number, (first, score) in enumerate(jumps):
        if first <= end:
            continue
        later = jumps[number + 1 : number + 1 + LATER_JUMPS]
        segments = [Segment(first, stop, min(score, other)) for stop, other in later]
        if not later or curve.spike_kind == "root elsewhere":
            segments.append(Segment(first, len(curve.values), score))
        ways = [(kind, segment) for segment in segments for kind in _kinds(curve, segment, sizes)]
        if ways:
            kind, segment = min(ways, key=lambda way: PREFERRED.index(way[0]))
            end = first if segment.end == len(curve.values) else segment.end
            yield segment, kind


def _jumps_of(curve: Curve, sensitivity: float = 0.5) -> list[tuple[int, float]]:
    """The frames to which a curve jumps from the frame before, each with its score."""
    steps = curve.steps()
    shortest = least_jump(curve.rate)
    large = np.flatnonzero(steps > shortest / (2 * sensitivity))
    if not len(large):
        return []
    padded = np.pad(steps, 1)
    neighbours = np.maximum(padded[large], padded[large + 2])
    usual = local_median(np.abs(np.diff(steps, append=steps[-1:])), curve.rate)[large]
    least = np.maximum(JUMP_TO_NEIGHBOURS_RATIO * neighbours, JUMP_TO_USUAL_RATIO * usual)
    score = steps[large] / np.maximum(shortest, least)
    if curve.is_root and curve.is_rotation:
        fastest = np.radians(FASTEST_DEGREES_A_SECOND) * curve.lever
        score = np.maximum(score, steps[large] * curve.rate / fastest)
    likely = score > 1 / (2 * sensitivity)
    return list(zip((large[likely] + 1).tolist(), score[likely].tolist(), strict=True))


def _kinds(curve: Curve, segment: Segment, sizes: dict[int, float]) -> Iterator[str]:
    """What a segment may be: a "spike", a displacement to be "undone" up to the jump back or "to
    the end", or values of another motion to be "interpolated". `sizes` are those of all jumps, by
    their frames, in metres."""
    if segment.end == len(curve.values):
        # A hand or a thumb may be turned by half a turn: a rig's limits are those of its limbs.
        degrees = max(HALF_TURN_DEGREES, FASTEST_DEGREES_A_SECOND / curve.rate)
        large = sizes[segment.first] > _least(curve, degrees)
        if large and curve.name in JOINTS:
            yield "to the end"
        return
    size = min(sizes[segment.first], sizes[segment.end])
    returns = size > _least(curve) and _returns(curve, segment)
    if returns and len(segment) <= longest_spike(curve.rate):
        yield "spike"
    closes = size > _least(curve) and _closes(curve, segment, size)
    if not (returns or closes) or not _is_between(curve, segment, size, sizes):
        return
    if closes:
        yield "undone"
    if returns:
        yield "interpolated"


def _is_between(curve: Curve, segment: Segment, size: float, sizes: dict[int, float]) -> bool:
    """Whether there is motion before and after a segment, without other jumps of half its size for
    as long as it lasts: else the frames outside may be the wrong ones."""
    few = longest_spike(curve.rate)
    first, end = segment.first, segment.end
    around = {*range(first - len(segment), first), *range(end + 1, end + len(segment) + 1)}
    others = [jump for jump in sizes.keys() & around if sizes[jump] > size / 2]
    return few < first and end < len(curve.values) - few and not others


def _all_jump(motion: Motion, curve: Curve, segment: Segment) -> bool:
    """Whether all joints that a rotation carries jump with it at one end of a segment or the other.
    If the knee jumps and the ankle does not, the leg is turned about the line from the hip to the
    ankle, and to interpolate the hip would lose where the ankle is."""
    jumps = []
    for frame in (segment.first, segment.end):
        places = carried(motion.at(slice(frame - 2, frame + 2)), curve) / body_size(motion)
        steps = np.diff(places, axis=0)
        jumps.append(np.linalg.norm(steps[1] - (steps[0] + steps[2]) / 2, axis=-1))
    return bool(np.all(np.maximum(*jumps) > least_jump(curve.rate) / 2))


def _finding(curve: Curve, segment: Segment, kind: str) -> Finding:
    """The finding of a segment that is one of `PREFERRED`."""
    first, end = segment.first, segment.end
    to_the_end = end == len(curve.values)
    of_rotation = "displaced" if kind == "interpolated" else "turned"
    kind = of_rotation if curve.is_rotation else curve.spike_kind
    step = curve.between(np.array([first - 1]), np.array([first]))
    amount = curve.amount(float(np.linalg.norm(step)))
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


def _least(curve: Curve, degrees: float = LEAST_TURN_DEGREES) -> float:
    """The least size of a jump that counts, metres."""
    return np.radians(degrees) * curve.lever if curve.is_rotation else least_jump(curve.rate)


def _closes(curve: Curve, segment: Segment, size: float) -> bool:
    """Whether the step out of a segment undoes the step into it, and these are large."""
    frames = slice(segment.first, segment.end)
    undoes = min(_remaining(curve, segment)) < CLOSING_SHARE * size
    return undoes and bool(curve.steps(frames).max(initial=0.0) < CALM_SHARE * size)


def _returns(curve: Curve, segment: Segment) -> bool:
    """Whether values are others for a short time only: after it, they are nearly what they were
    before, or the two steps are opposite."""
    if len(segment) > LONGEST_SECONDS * curve.rate:
        return False
    before, after = np.array([segment.first - 1]), np.array([segment.end])
    step_in = curve.between(before, before + 1)[0]
    step_out = curve.between(after - 1, after)[0]
    away, back = float(np.linalg.norm(step_in)), float(np.linalg.norm(step_out))
    left = float(np.linalg.norm(curve.between(before, after)))
    smaller = min(away, back)
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
            return inverse(join_rotations(inverse(x), first, end))
        return join_rotations(x, first, end)
    corrections = []
    if first:
        corrections.append(2 * x[first - 1] - x[max(first - 2, 0)] - inside[0])
    if end < len(x):
        corrections.append(2 * x[end] - x[min(end + 1, len(x) - 1)] - inside[-1])
    share = np.linspace(0.0, 1.0, len(inside))[:, None]
    return inside + (1 - share) * corrections[0] + share * corrections[-1]


def _leaves_floor(motion: Motion, curve: Curve, frames: slice, values: np.ndarray) -> bool:
    """Whether the feet of the frames at one end of a motion would leave the floor of the others
    with other values of the root: the path goes on elsewhere, at the same height."""
    has_ends = 0 < frames.start and frames.stop < len(motion)
    if curve.spike_kind != "root elsewhere" or has_ends:
        return False
    toes = curves.usual_toes(motion)
    outside = slice(None, frames.start) if frames.start else slice(frames.stop, None)
    off = floor_height(toes[frames]) - floor_height(toes[outside])
    rise = curve.lever * float(np.mean(values[:, 1] - curve.values[frames, 1]))
    return abs(off + rise) > abs(off)
