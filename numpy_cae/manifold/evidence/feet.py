"""Feet that stand still, on the floor.

A foot stands while its toe is low and slow. The place where it stands is the median of the toe over
that time, at the height at which toes stand in this motion. The displacement from the toe to that
place fades out before and after (`EASE`). The root takes the mean displacement of both feet, so
that the legs change little; each leg takes the rest by its own two bones, which keep their lengths
(`motion.retarget.to_rig.bent`).
"""

from dataclasses import replace

import numpy as np

from numpy_cae.manifold.evidence.finding import Finding
from numpy_cae.manifold.evidence.jitter import jumping_steps
from numpy_cae.manifold.evidence.jumps import confidence
from numpy_cae.motion.contacts import FEET, foot_sliding
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.masks import runs, with_margin
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import body_positions
from numpy_cae.motion.retarget.to_rig import bent, retarget

SLOW, LOW = 0.5, 0.05
"""SLOW, LOW: a toe stands if it is slower than SLOW (m/s) and at most LOW (m) above the height at
which toes stand, the median height of the lower toe where it is slow."""
SECONDS = 0.15
"""SECONDS: for at least this time (s)."""
LEAST = 0.04
"""LEAST: the feet of a motion are changed if one of them is further than this (m) from its place
while it stands."""
EASE = 0.2
"""EASE: the displacement of a foot fades in and out in this time (s)."""
ROUNDS = 4
"""ROUNDS: feet are looked for again at most so often."""


def find_feet(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """The times in which a foot stands and slides, or is in the floor or above it.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> find_feet(motion)
    []
    >>> motion.translations[:, 0, 0] += np.linspace(0.0, 0.6, 60)
    >>> find_feet(motion)[0].kind
    'foot'
    """
    toes, level = _toes(motion)
    found = []
    for foot, first, end in _stances(toes, level, motion.rate):
        toe = toes[first:end, foot]
        away = np.abs(toe - _place(toe, level)).max(axis=0)
        slide, height = 100 * max(away[0], away[2]), 100 * away[1]
        why = f"moves by {slide:.1f} cm, {height:.1f} cm off the floor"
        toe_name = ("left_toe", "right_toe")[foot]
        found.append((away.max(), Finding(toe_name, (first, end - 1), "foot", why)))
    worst = max((away for away, _ in found), default=0.0)
    if worst * 2 * sensitivity <= LEAST:
        return []
    return [replace(finding, confidence=confidence(worst / LEAST)) for _, finding in found]


def mend_feet(motion: Motion, findings: list[Finding]) -> Motion:
    """The motion with the feet of the findings at their places; the motion itself if the feet would
    slide more (`foot_sliding`), or more joints jump.

    A foot that stands still does so for longer than it seemed: it is looked for again, as long as
    that helps.
    """
    stances = [(int(f.joint.startswith("right")), f.frames[0], f.frames[1] + 1) for f in findings]
    slides, jumps = foot_sliding(body_positions(motion), motion.rate), jumping_steps(motion)
    for _ in range(ROUNDS):
        better = _standing(motion, stances)
        new = (jumping_steps(better) & ~jumps).any(axis=1, keepdims=True)
        if new.any():
            near = with_margin(new, round(EASE * motion.rate) + 1)
            better = _standing(motion, [(x, a, b) for x, a, b in stances if not near[a:b].any()])
        after, left = foot_sliding(body_positions(better), motion.rate), jumping_steps(better)
        if after >= slides or left.sum() > jumps.sum():
            break
        motion, slides, jumps = better, after, left
        stances = _stances(*_toes(motion), motion.rate)
    return motion


def _stances(toes: np.ndarray, level: float, rate: float) -> list[tuple[int, int, int]]:
    """The foot, the first frame and the end of each time in which a foot stands."""
    if len(toes) < 3:
        return []
    speed = np.linalg.norm(np.gradient(toes, axis=0), axis=-1) * rate
    stands = (speed < SLOW) & (toes[..., 1] < level + LOW)
    return [
        (foot, first, end)
        for foot in (0, 1)
        for first, end in runs(stands[:, foot]).tolist()
        if end - first >= SECONDS * rate
    ]


def _standing(motion: Motion, stances: list[tuple[int, int, int]]) -> Motion:
    """The motion with each foot at its place while it stands."""
    toes, level = _toes(motion)
    shift, weight = np.zeros(toes.shape), np.zeros((*toes.shape[:2], 1))
    frame = np.arange(len(motion))
    for foot, first, end in stances:
        nearest = np.clip(frame, first, end - 1)
        u = np.clip(1 - np.abs(frame - nearest) / (EASE * motion.rate + 1), 0.0, 1.0)
        share = (u * u * (3 - 2 * u))[:, None]
        place = _place(toes[first:end, foot], level)
        shift[:, foot] += share * (place - toes[nearest, foot])
        weight[:, foot] += share
    shift /= np.maximum(weight, 1.0)
    weight = np.minimum(weight, 1.0)
    root = shift.sum(axis=1) / np.maximum(weight.sum(axis=1), 1.0)
    body = body_positions(motion)
    targets = body + root[:, None]
    for foot, toe in enumerate(FEET):
        hip, knee, ankle = toe - 3, toe - 2, toe - 1
        targets[:, [ankle, toe]] += (shift[:, foot] - weight[:, foot] * root)[:, None]
        chain = body[:, [hip, knee, ankle]]
        targets[:, knee] = bent(targets[:, hip], chain, targets[:, knee], targets[:, ankle])
    changed = np.asarray(weight.any(axis=(1, 2)))
    return retarget(motion, targets, np.repeat(changed[:, None], len(JOINTS), axis=1))


def _toes(motion: Motion) -> tuple[np.ndarray, float]:
    """The places of both toes, (frames, 2, 3) in metres, and the height at which they stand."""
    toes = body_positions(motion)[:, FEET]
    lower = toes[..., 1].min(axis=1)
    step = np.linalg.norm(np.diff(toes, axis=0, append=toes[-1:]), axis=-1).min(axis=1)
    slow = step * motion.rate < SLOW
    return toes, float(np.median(lower[slow] if slow.any() else lower))


def _place(toe: np.ndarray, level: float) -> np.ndarray:
    """Where a toe (frames, 3) stands: its median, at the height of the floor."""
    x, _, z = np.median(toe, axis=0)
    return np.array([x, level, z])
