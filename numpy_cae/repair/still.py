"""Frames that repeat the values of the frame before until the motion jumps.

Dropped frames, a sensor that stops and a pose of reference look like this. A person who stands
still is never exactly still, a channel that is not used does not jump, and a joint at its limit
returns to the same value.
"""

import numpy as np

from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.finding import BODY, Finding
from numpy_cae.repair.jumps import STILL, Curve, confidence, curves_of

SECONDS = 0.2
"""SECONDS: a single rotation is frozen if it stands still for at least this (s), and 6 frames."""
LEAST, CAUGHT_UP = 0.03, 2.5
"""LEAST, CAUGHT_UP: it then moves by more than LEAST (m), and than CAUGHT_UP times the median of
the three steps after that; so does the body after repeated frames, by the mean of its steps."""
USED = 0.75
"""USED: a rotation that stands still for more than this part of the file is not frozen."""


def find_still(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """Findings of the kinds "repeated" (the whole body) and "frozen" (one rotation).

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("run", 0, seconds=2.0, rate=30.0).motion
    >>> find_still(motion.at(np.r_[:30, [29] * 5, 35:60]))
    [body: frames 30 to 34: repeated (...
    """
    curves = [curve for curve in curves_of(motion) if curve.kind != "length"]
    if not curves:
        return []
    body, found = np.zeros(len(motion) - 1), []
    for curve in curves:
        steps = curve.steps()
        body += steps / len(curves)
        if curve.is_rotation and np.mean(steps <= STILL) < USED:
            least = max(6, round(SECONDS * motion.rate))
            frozen = _still(curve.name, "frozen", steps, least, LEAST, sensitivity)
            found += [finding for finding in frozen if not _recurs(curve, *finding.frames)]
    repeated = _still(BODY, "repeated", body, 1, 0.0, sensitivity)
    whole = {frame for f in repeated for frame in range(f.frames[0], f.frames[1] + 1)}
    return repeated + [f for f in found if not whole.issuperset(range(f.frames[0], f.frames[1]))]


def _recurs(curve: Curve, first: int, last: int) -> bool:
    """Whether a value that stands still is also met elsewhere: the limit of a joint."""
    same = np.abs(curve.values - curve.values[last]).max(axis=-1) <= STILL
    return bool(same[: max(first - 1, 0)].any() or same[last + 1 :].any())


def _still(
    joint: str, kind: str, steps: np.ndarray, frames: int, least: float, sensitivity: float
) -> list[Finding]:
    """The runs of at least `frames` steps that stand still and end with a jump."""
    found = []
    for first, end in runs(steps <= STILL):
        if end - first < frames or end == len(steps):
            continue
        into = _score(steps[first - 1], steps[max(first - 4, 0) : first - 1], least) if first else 0
        score = _score(steps[end], steps[end + 1 : end + 4], least)
        if max(score, into) * 2 * sensitivity > 1:
            # A jump into the run, or its start at that of the file, shows that its first frame is
            # wrong too; of a whole body the first pose is a true one.
            start = first if into > 1 or (least > 0 and first == 0) else first + 1
            moves = f"then moves by {100 * steps[end]:.1f} cm"
            why = f"stands still for {end - first + 1} frames, {moves}"
            sure = confidence(max(score, into))
            found.append(Finding(joint, (int(start), int(end)), kind, why, 0.0, sure))
    return found


def _score(step: float, beside: np.ndarray, least: float) -> float:
    """How many times the threshold of a jump a step is."""
    if not len(beside):
        return 0.0
    return float(step / max(least, CAUGHT_UP * float(np.median(beside)), STILL))
