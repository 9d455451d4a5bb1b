"""What is displaced between a jump and the jump back, or from a jump on.

A rotation that is turned by a constant turn Q, in its own frame or in its parent's, jumps by Q and
back by Q⁻¹, and a root that is moved by D jumps by D and back by -D:

    R'_t = R_t Q    or    R'_t = Q R_t    or    p'_t = p_t + D,    a < t ≤ b

Such a displacement is undone: the values next to each jump are moved to where the motion outside
continues, and those between the jumps by a displacement interpolated between these two. A root that
does not come back, and a rotation by half a turn that does not, are undone up to the end of the
file; or up to its start if that has a few frames only, such as a pose before the motion.

If two opposite jumps do not undo each other, the rotations between them are those of another
motion: they are interpolated (`holes`).
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import angle, inverse, product, slerp
from numpy_cae.repair.finding import Finding
from numpy_cae.repair.interpolated import interpolate
from numpy_cae.repair.jumps import Curve, confidence, curves_of, jumps_of

CLOSES = 0.3
"""CLOSES: two jumps undo each other if what is left is at most this part of the smaller one."""
CALM = 0.35
"""CALM: and if no step between them is longer than this part of it."""
TURN, PLACE = 20.0, 0.1
"""TURN, PLACE: jumps of less than this, in degrees and in metres, do not count."""
LONGEST, OPPOSITE = 1.5, 0.5
"""LONGEST, OPPOSITE: rotations are interpolated between two jumps at most LONGEST (s) apart that
lead back, or, of joints other than the root, whose directions have a cosine of less than -OPPOSITE:
a body that turns and turns back may kick."""
NEXT = 6
"""NEXT: a jump is compared with this many later ones."""
SPIKE = 3
"""SPIKE: what is displaced for at most this many frames is a spike, and not looked at here."""
HALF = 150.0
"""HALF: a rotation that jumps by this many degrees and does not come back is undone."""


def find_displaced(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """Findings of the kinds "turned", "displaced" and "root elsewhere".

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
    return [finding for curve in curves_of(motion) for finding in _displaced(curve, sensitivity)]


def mend_displaced(motion: Motion, findings: list[Finding]) -> Motion:
    """The motion with displacements undone, and what is "displaced" interpolated."""
    changed: dict[str, Any] = {}  # rotations and translations
    for curve in curves_of(motion):
        kind = "turned" if curve.is_rotation else curve.kind
        name = "rotations" if curve.is_rotation else "translations"
        for first, last in (f.frames for f in findings if (f.joint, f.kind) == (curve.name, kind)):
            if name not in changed:  # an hour of rotations takes 0.4 GB: one copy for all joints
                changed[name] = getattr(motion, name).copy()
            changed[name][first : last + 1, curve.joint] = _undone(curve, first, last + 1)
    undone = replace(motion, **changed)
    return interpolate(undone, [f for f in findings if f.kind == "displaced"])


def _displaced(curve: Curve, sensitivity: float) -> Iterator[Finding]:
    jumps, frames, free = jumps_of(curve, sensitivity), len(curve.values), 0
    undone, other = ("turned", "displaced") if curve.is_rotation else (curve.kind, curve.kind)
    for number, (at, score) in enumerate(jumps):
        if at < free:
            continue
        first = at + 1
        later = [(back + 1, min(score, sure)) for back, sure in jumps[number + 1 :][:NEXT]]
        soon = [end for end, _ in later if end - first <= SPIKE]
        spike = [end for end in soon if _returns(curve, first, end)]
        if spike:
            free = spike[-1]
            continue
        to_the_end = not later and _size(curve, first) > _least(curve, HALF)
        choices = (
            (undone, [x for x in later if _closes(curve, first, x[0])]),
            (other, [x for x in later if _returns(curve, first, x[0])]),
            (undone, [(frames, score)] if to_the_end else []),
        )
        for kind, ends in choices:
            if ends:
                free, sure = ends[0]
                amount = curve.amount(_size(curve, first))
                if free == frames and first <= SPIKE:  # a pose to begin with: the rest is right
                    first, free = 0, first
                back = " and back" if first and free < frames else ""
                why = f"{'turns' if curve.is_rotation else 'moves'} by {amount} in a frame{back}"
                yield Finding(curve.name, (first, free - 1), kind, why, 0.0, confidence(sure))
                break


def _size(curve: Curve, frame: int) -> float:
    """The length of the step to a frame, metres."""
    return float(np.linalg.norm(curve.between(np.array([frame - 1]), np.array([frame]))))


def _least(curve: Curve, turn: float = TURN) -> float:
    """The least size of a jump that counts, metres."""
    return np.radians(turn) * curve.lever if curve.is_rotation else PLACE


def _closes(curve: Curve, first: int, end: int) -> bool:
    """Whether the step to the frame `end` undoes the step to `first`, and these are large."""
    size = min(_size(curve, first), _size(curve, end))
    undo = size > _least(curve) and min(_left(curve, first, end)) < CLOSES * size
    return bool(undo and curve.steps(slice(first, end)).max() < CALM * size)


def _returns(curve: Curve, first: int, end: int) -> bool:
    """Whether values are others for a short time only: after it, they are nearly what they were
    before, or the two steps are opposite."""
    before, after = np.array([first - 1, end - 1]), np.array([first, end])
    steps = [*curve.between(before, after), *curve.between(before[:1], after[1:])]
    away, back, there = map(float, np.linalg.norm(steps, axis=-1))
    smaller = min(away, back)
    opposite = steps[0] @ steps[1] < -OPPOSITE * away * back and max(away, back) < 2 * smaller
    short = end - first <= LONGEST * curve.rate
    other = (opposite and not curve.is_root) or there < CLOSES * smaller
    return bool(short and smaller > _least(curve) and other)


def _left(curve: Curve, first: int, end: int) -> list[float]:
    """What is left of the two jumps, in metres: in the joint's own frame, and for rotations in its
    parent's (the inverse rotations)."""
    x = curve.values[[first - 1, first, end - 1, end]]
    if not curve.is_rotation:
        return [float(np.linalg.norm(x[1] - x[0] + x[3] - x[2]))]
    jumps = ([product(inverse(q[at]), q[at + 1]) for at in (0, 2)] for q in (x, inverse(x)))
    return [curve.lever * float(angle(product(*pair))) for pair in jumps]


def _undone(curve: Curve, first: int, end: int) -> np.ndarray:
    """The values of the frames from `first` to `end` with their displacement undone."""
    last = end == len(curve.values)
    one_sided = last or not first
    is_own = one_sided or not np.argmin(_left(curve, first, end))  # not in the parent's frame
    x = curve.values if is_own else inverse(curve.values)
    inside = x[first:end]
    sides = [(inside[0], x[max(first - 2, 0) : first])] if first else []
    if not last:
        sides.append((inside[-1], x[end : end + 2][::-1]))
    share = np.linspace(0.0, 1.0, len(inside))
    if not curve.is_rotation:
        one, other = ([2 * y[-1] - y[0] - now for now, y in sides] * 2)[:2]
        return inside + (1 - share[:, None]) * one + share[:, None] * other
    turns = [
        product(inverse(now), product(product(y[-1], inverse(y[0])), y[-1])) for now, y in sides
    ]
    one, other = (turns * 2)[:2]
    rotations = product(inside, slerp(one, other, share))
    return rotations if is_own else inverse(rotations)
