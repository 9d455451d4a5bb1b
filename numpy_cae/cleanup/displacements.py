"""Displacements between a jump and the jump back, or from a jump on.

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

import numpy as np

from numpy_cae.cleanup.channels import Candidate, Channel, least_jump, local_median
from numpy_cae.cleanup.finding import Finding, confidence
from numpy_cae.cleanup.interpolation import interpolate_channels
from numpy_cae.cleanup.kinds import DISPLACED, ROOT, TURNED, Kind, kind_of_place
from numpy_cae.cleanup.spikes import longest_spike, positions_moved_by
from numpy_cae.cleanup.view import View
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.contacts import floor_height
from numpy_cae.motion.hole_curves import join_rotations
from numpy_cae.motion.quaternions import angle, inverse, product

JUMP_TO_NEIGHBOURS_RATIO = 3.0
"""A step is a jump only if it is longer than this times the steps before and after it."""
JUMP_TO_USUAL_RATIO = 8.0
"""A step is a jump only if it is longer than this times the median, over a second, of the change
from step to step."""
FASTEST_DEGREES_A_SECOND = 1500.0
"""The whole body does not turn faster than this (° a second)."""
UNDOING_SHARE = 0.3
"""Two jumps undo each other if what remains is at most this share of the smaller one."""
CALM_SHARE = 0.35
"""Two jumps undo each other if no step between them is longer than this share of the smaller
one."""
LEAST_TURN_DEGREES = 20.0
"""A jump of a rotation counts if it is larger than this (°)."""
LONGEST_DISPLACED_SECONDS = 1.5
"""Rotations are interpolated between two jumps that are at most this far apart (s)."""
LATER_JUMPS = 6
"""A candidate ends at one of this many jumps after the one at which it begins."""
OPPOSITE_COSINE = -0.5
"""Two jumps whose directions have a cosine below this lead back; those of the root do not count,
since a body that turns and turns back may kick."""
IS_SPIKE = "spike"
"""A candidate is left to `find_spikes`."""
UNDONE = "undone"
"""A candidate is a displacement, which is undone up to the jump back."""
INTERPOLATED = "interpolated"
"""A candidate has values of another motion, which are interpolated."""
TO_THE_END = "to the end"
"""A candidate is a displacement up to the end of the motion."""
PREFERRED = (IS_SPIKE, UNDONE, INTERPOLATED, TO_THE_END)
"""A candidate that may be several of these is taken for the first of them."""
HALF_TURN_DEGREES = 150.0
"""A rotation that jumps by more than this (°) and does not come back is undone."""


def find_displacements(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """Findings of the kinds "turned", "displaced", "length" and "root elsewhere".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[40:, 0] += [0.5, 0.0, 0.0]
    >>> find_displacements(View(motion))
    [hips: frames 40 to 59: root elsewhere (moves by 51.6 cm in a frame): confidence ...

    A first frame that stands elsewhere is moved to the rest, not the rest to it:

    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[0, 0] += [0.5, 0.0, 0.0]
    >>> view = View(motion)
    >>> find_displacements(view)
    [hips: frame 0: root elsewhere (moves by 49.4 cm in a frame): confidence ...
    >>> mended = mend_displacements(view, find_displacements(view))
    >>> bool(np.ptp(mended.translations[:2, 0], axis=0).max() < 0.05)
    True
    """
    findings = []
    for channel in view.channels:
        for candidate, way in _classify(channel, sensitivity):
            if way == IS_SPIKE:
                continue
            if way == INTERPOLATED and not _all_jump(view, channel, candidate):
                continue
            findings.append(_finding(channel, candidate, way))
    return findings


def mend_displacements(view: View, findings: list[Finding]) -> Motion:
    """The motion with displacements undone; what is "displaced" is interpolated, and places that
    are others for as short a time as a spike."""
    offsets = []
    interpolated = []
    for finding in findings:
        is_brief_place = finding.row.is_of_translation and _is_brief(finding, view)
        if finding.row.is_offset and not is_brief_place:
            offsets.append(finding)
        else:
            interpolated.append(finding)
    return interpolate_channels(_undo_offsets(view, offsets), interpolated)


def _undo_offsets(view: View, findings: list[Finding]) -> Motion:
    """The motion without the offsets of findings."""
    rotations = view.motion.rotations
    translations = view.motion.translations
    if any(not finding.row.is_of_translation for finding in findings):
        rotations = rotations.copy()
    if any(finding.row.is_of_translation for finding in findings):
        translations = translations.copy()
    for channel in view.channels:
        kind = _kind_of_offset(channel)
        values = rotations if channel.is_rotation else translations
        for finding in findings:
            if finding.joint == channel.name and finding.row is kind:
                frames = finding.stretch
                undone = _undo(channel, frames)
                if _leaves_floor(view, channel, frames, undone):
                    undone[:, 1] = channel.values[frames, 1]
                values[frames, channel.joint] = undone
                channel = replace(channel, values=values[:, channel.joint])
    return replace(view.motion, rotations=rotations, translations=translations)


def _kind_of_offset(channel: Channel) -> Kind:
    """What a finding says if the values of a channel are off by an offset that is undone."""
    return TURNED if channel.is_rotation else kind_of_place(channel.channel)


def _is_brief(finding: Finding, view: View) -> bool:
    """Whether a finding has frames before and after it and is no longer than a spike."""
    first, end = finding.stretch.start, finding.stretch.stop
    return 0 < first and end < len(view) and end - first <= longest_spike(view.rate)


def _classify(channel: Channel, sensitivity: float) -> Iterator[tuple[Candidate, str]]:
    """The runs of a channel that are displaced, each with one of `PREFERRED`; none overlaps
    another, but for those up to the end of the channel."""
    jumps = _jumps_of(channel, sensitivity)
    frames = np.array([frame for frame, _ in jumps], int)
    lengths = np.linalg.norm(channel.between(frames - 1, frames), axis=1)
    sizes = dict(zip(frames.tolist(), lengths.tolist(), strict=True))
    end = 0
    for number, (first, _) in enumerate(jumps):
        if first <= end:
            continue
        ways = []
        for candidate in _candidates_from(channel, jumps, number):
            for way in _ways(channel, candidate, sizes):
                ways.append((candidate, way))
        if ways:
            candidate, way = min(ways, key=lambda pair: PREFERRED.index(pair[1]))
            end = first if candidate.end == len(channel.values) else candidate.end
            yield candidate, way


def _candidates_from(
    channel: Channel, jumps: list[tuple[int, float]], number: int
) -> list[Candidate]:
    """The candidates that begin at a jump, given by its number among all `jumps`."""
    first, score = jumps[number]
    later = jumps[number + 1 : number + 1 + LATER_JUMPS]
    candidates = []
    for end, score_at_end in later:
        candidates.append(Candidate(first, end, min(score, score_at_end)))
    if not later or channel.channel == ROOT:
        candidates.append(Candidate(first, len(channel.values), score))
    return candidates


def _jumps_of(channel: Channel, sensitivity: float = 0.5) -> list[tuple[int, float]]:
    """The frames to which a channel jumps from the frame before, each with its score."""
    steps = channel.steps()
    shortest = least_jump(channel.rate)
    large = np.flatnonzero(steps > shortest / (2 * sensitivity))
    if not len(large):
        return []
    padded = np.pad(steps, 1)
    neighbours = np.maximum(padded[large], padded[large + 2])
    usual = local_median(np.abs(np.diff(steps, append=steps[-1:])), channel.rate)[large]
    least = np.maximum(JUMP_TO_NEIGHBOURS_RATIO * neighbours, JUMP_TO_USUAL_RATIO * usual)
    score = steps[large] / np.maximum(shortest, least)
    if channel.is_root and channel.is_rotation:
        fastest = np.radians(FASTEST_DEGREES_A_SECOND) * channel.lever
        score = np.maximum(score, steps[large] * channel.rate / fastest)
    likely = score > 1 / (2 * sensitivity)
    return list(zip((large[likely] + 1).tolist(), score[likely].tolist(), strict=True))


def _ways(channel: Channel, candidate: Candidate, sizes: dict[int, float]) -> Iterator[str]:
    """Which of `PREFERRED` a candidate may be. `sizes` are those of all jumps, by their frames, in
    metres."""
    if candidate.end == len(channel.values):
        # A hand or a thumb may be turned by half a turn: a rig's limits are those of its limbs.
        degrees = max(HALF_TURN_DEGREES, FASTEST_DEGREES_A_SECOND / channel.rate)
        large = sizes[candidate.first] > _least(channel, degrees)
        if large and channel.name in JOINTS:
            yield TO_THE_END
        return
    size = min(sizes[candidate.first], sizes[candidate.end])
    returns = size > _least(channel) and _returns(channel, candidate)
    if returns and len(candidate) <= longest_spike(channel.rate):
        yield IS_SPIKE
    closes = size > _least(channel) and _closes(channel, candidate, size)
    if not (returns or closes) or not _is_between(channel, candidate, size, sizes):
        return
    if closes:
        yield UNDONE
    if returns:
        yield INTERPOLATED


def _is_between(
    channel: Channel, candidate: Candidate, size: float, sizes: dict[int, float]
) -> bool:
    """Whether there is motion before and after a candidate, without other jumps of half its size
    for as long as it lasts: else the frames outside may be the wrong ones."""
    few = longest_spike(channel.rate)
    first, end = candidate.first, candidate.end
    if first <= few or end >= len(channel.values) - few:
        return False
    length = len(candidate)
    around = {*range(first - length, first), *range(end + 1, end + length + 1)}
    return not any(sizes[jump] > size / 2 for jump in sizes.keys() & around)


def _all_jump(view: View, channel: Channel, candidate: Candidate) -> bool:
    """Whether all joints that a rotation moves jump with it at one end of a candidate or the other.
    If the knee jumps and the ankle does not, the leg is turned about the line from the hip to the
    ankle, and to interpolate the hip would lose where the ankle is."""
    jumps = []
    for frame in (candidate.first, candidate.end):
        near = view.motion.at(slice(frame - 2, frame + 2))
        steps = np.diff(positions_moved_by(near, channel) / view.size, axis=0)
        jumps.append(np.linalg.norm(steps[1] - (steps[0] + steps[2]) / 2, axis=-1))
    return bool(np.all(np.maximum(*jumps) > least_jump(channel.rate) / 2))


def _finding(channel: Channel, candidate: Candidate, way: str) -> Finding:
    """The finding of a candidate that is one of `PREFERRED`."""
    first, end = candidate.first, candidate.end
    to_the_end = end == len(channel.values)
    kind = _kind_of_offset(channel)
    if channel.is_rotation and way == INTERPOLATED:
        kind = DISPLACED
    step = channel.between(np.array([first - 1]), np.array([first]))
    amount = channel.amount(float(np.linalg.norm(step)))
    few = longest_spike(channel.rate) if channel.is_rotation else end / 2
    if to_the_end and first <= few:
        first, end = 0, first
    moves = "turns" if channel.is_rotation else "moves"
    evidence = f"{moves} by {amount} in a frame"
    if not to_the_end:
        evidence += " and back"
    status = "repaired"
    if to_the_end and channel.is_rotation and not channel.is_root:
        # Which half of a limb's motion is turned is not certain: either may be a pose of people.
        status = "proposed"
    frames = (first, end - 1)
    sure = confidence(candidate.score)
    return Finding(channel.name, frames, kind.name, evidence, 0.0, sure, status)


def _least(channel: Channel, degrees: float = LEAST_TURN_DEGREES) -> float:
    """The least size of a jump that counts, metres."""
    return np.radians(degrees) * channel.lever if channel.is_rotation else least_jump(channel.rate)


def _closes(channel: Channel, candidate: Candidate, size: float) -> bool:
    """Whether the step out of a candidate undoes the step into it, and these are large."""
    frames = slice(candidate.first, candidate.end)
    undoes = min(_remaining(channel, candidate)) < UNDOING_SHARE * size
    return undoes and bool(channel.steps(frames).max(initial=0.0) < CALM_SHARE * size)


def _returns(channel: Channel, candidate: Candidate) -> bool:
    """Whether values are others for a short time only: after it, they are nearly what they were
    before, or the two steps are opposite."""
    if len(candidate) > LONGEST_DISPLACED_SECONDS * channel.rate:
        return False
    before, after = np.array([candidate.first - 1]), np.array([candidate.end])
    step_in = channel.between(before, before + 1)[0]
    step_out = channel.between(after - 1, after)[0]
    away, back = float(np.linalg.norm(step_in)), float(np.linalg.norm(step_out))
    remaining = float(np.linalg.norm(channel.between(before, after)))
    smaller = min(away, back)
    opposite = step_in @ step_out < OPPOSITE_COSINE * away * back and max(away, back) < 2 * smaller
    return bool((opposite and not channel.is_root) or remaining < UNDOING_SHARE * smaller)


def _remaining(channel: Channel, candidate: Candidate) -> list[float]:
    """What remains of the two jumps, in metres: in the joint's own frame, and for rotations in its
    parent's (the inverse rotations)."""
    first, end = candidate.first, candidate.end
    x = channel.values[[first - 1, first, end - 1, end]]
    if not channel.is_rotation:
        return [channel.lever * float(np.linalg.norm(x[1] - x[0] + x[3] - x[2]))]
    remaining = []
    for q in (x, inverse(x)):
        jump_in = product(inverse(q[0]), q[1])
        jump_out = product(inverse(q[2]), q[3])
        remaining.append(channel.lever * float(angle(product(jump_in, jump_out))))
    return remaining


def _undo(channel: Channel, frames: slice) -> np.ndarray:
    """The values of some frames with their displacement undone."""
    x = channel.values
    first, end = frames.start, frames.stop
    inside = x[first:end]
    if channel.is_rotation:
        has_ends = 0 < first and end < len(x)
        if has_ends and np.argmin(_remaining(channel, Candidate(first, end, 0.0))) == 1:
            return inverse(join_rotations(inverse(x), first, end))
        return join_rotations(x, first, end)
    corrections = []
    if first:
        corrections.append(2 * x[first - 1] - x[max(first - 2, 0)] - inside[0])
    if end < len(x):
        corrections.append(2 * x[end] - x[min(end + 1, len(x) - 1)] - inside[-1])
    share = np.linspace(0.0, 1.0, len(inside))[:, None]
    return inside + (1 - share) * corrections[0] + share * corrections[-1]


def _leaves_floor(view: View, channel: Channel, frames: slice, values: np.ndarray) -> bool:
    """Whether the feet of the frames at one end of a motion would leave the floor of the others
    with other values of the root: the path goes on elsewhere, at the same height."""
    has_ends = 0 < frames.start and frames.stop < len(view)
    if channel.channel != ROOT or has_ends:
        return False
    outside = slice(None, frames.start) if frames.start else slice(frames.stop, None)
    off = floor_height(view.toes[frames]) - floor_height(view.toes[outside])
    rise = channel.lever * float(np.mean(values[:, 1] - channel.values[frames, 1]))
    return abs(off + rise) > abs(off)
