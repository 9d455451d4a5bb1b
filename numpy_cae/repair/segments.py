"""Segments of a curve: runs of frames that may be damaged, listed before anything is decided.

A segment either stands still (`still_segments`), or begins after a jump and ends at a later one
(`segments_between_jumps`), or leaves the cubic through the frames around it (`repair.spikes`). Each
has a score, the evidence divided by its threshold; `still`, `displaced` and `spikes` then decide
what the damage is, if it is any.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from numpy_cae.motion.masks import runs
from numpy_cae.repair.curves import STILL_METRES, Curve, local_median

CAUGHT_UP_RATIO = 2.5
"""CAUGHT_UP_RATIO: what stood still ends with a step of more than this times the median of the
three steps after it."""
JUMP_METRES = 0.08
"""JUMP_METRES: a step is a jump only if it is longer than this (m)."""
JUMP_TO_NEIGHBOURS = 3.0
"""JUMP_TO_NEIGHBOURS: a step is a jump only if it is longer than this times the steps before and
after it."""
JUMP_TO_USUAL = 8.0
"""JUMP_TO_USUAL: a step is a jump only if it is longer than this times the median, over a second,
of the change from step to step."""
FASTEST_TURN = 1500.0
"""FASTEST_TURN: the whole body does not turn faster than this (° a second)."""
LATER_JUMPS = 6
"""LATER_JUMPS: a segment ends at one of this many jumps after the one at which it begins."""


class Segment(NamedTuple):
    """A run of frames of a curve.

    Parameters
    ----------
    first, end : int
        The first frame, and the frame after the last one.
    score : float
        The evidence divided by its threshold: above 1 it is strong enough.
    size : float
        How far the curve is displaced there, in metres; 0 where it was not measured.
    """

    first: int
    end: int
    score: float
    size: float = 0.0

    def __len__(self) -> int:
        return self.end - self.first


def jumps_of(curve: Curve, sensitivity: float = 0.5) -> list[tuple[int, float]]:
    """The frames to which a curve jumps from the frame before, each with its score."""
    steps = curve.steps()
    large = np.flatnonzero(steps > JUMP_METRES / (2 * sensitivity))
    if not len(large):
        return []
    padded = np.pad(steps, 1)
    neighbours = np.maximum(padded[large], padded[large + 2])
    usual = local_median(np.abs(np.diff(steps, append=steps[-1:])), curve.rate)[large]
    least = np.maximum(JUMP_TO_NEIGHBOURS * neighbours, JUMP_TO_USUAL * usual)
    score = steps[large] / np.maximum(JUMP_METRES, least)
    if curve.is_root and curve.is_rotation:
        fastest = np.radians(FASTEST_TURN) * curve.lever
        score = np.maximum(score, steps[large] * curve.rate / fastest)
    likely = score > 1 / (2 * sensitivity)
    return list(zip((large[likely] + 1).tolist(), score[likely].tolist(), strict=True))


def segments_between_jumps(curve: Curve, sensitivity: float) -> Iterator[list[Segment]]:
    """For each jump the segments that begin with it: to each of the next jumps, or, if there is
    none, to the end of the curve."""
    jumps = jumps_of(curve, sensitivity)
    for number, (first, score) in enumerate(jumps):
        later = jumps[number + 1 : number + 1 + LATER_JUMPS]
        segments = [Segment(first, end, min(score, other)) for end, other in later]
        yield segments or [Segment(first, len(curve.values), score)]


def still_segments(
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
