"""Spikes: a rotation or a place that jumps away and back within a few frames.

A run of n frames is compared with the cubic through the two frames before it and the two after it.
Its deviation is the smaller one of its first and its last frame: that of a run which is longer than
the spike, or beside it, is nearly 0. Of runs that touch each other, the one with the largest
deviation is the spike. It is removed and the rest is searched again, as a spike also distorts the
cubics beside it.

The joints below must deviate from their cubics too: where the rotations of several joints jump and
these jumps cancel, the body does not.
"""

import numpy as np

from numpy_cae.motion.motion import Motion
from numpy_cae.repair.finding import Finding
from numpy_cae.repair.interpolated import interpolated
from numpy_cae.repair.jumps import Curve, confidence, curves_of, local_median

SECONDS = 0.1
"""SECONDS: the longest spike, but at any rate three frames."""
LEAST, TIMES = 0.08, 9.0
"""LEAST, TIMES: a spike deviates by more than LEAST (m), and than TIMES the median over a second of
the deviations of single frames, which is that of the noise."""
BESIDE = 1.5
"""BESIDE: and by more than this times the larger step just before or after it, plus the first step
within it."""
SAME_WAY = 0.5
"""SAME_WAY: a run is no spike if the cosine of the angle between the steps to it and from it is at
least this: it is passed through, as by the elbow of a runner at 24 frames a second."""
ROUNDS = 4
"""ROUNDS: how often the rest is searched again."""


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
        for _ in range(ROUNDS):
            runs = _that_move(motion, curve, _spikes(curve, sensitivity), sensitivity)
            if not runs:
                break
            for first, end, size, score in runs:
                why = f"{curve.amount(size)} from the frames before and after"
                sure = confidence(score)
                found.append(Finding(curve.name, (first, end - 1), curve.kind, why, 0.0, sure))
            curve = interpolated(curve, [(first, end) for first, end, *_ in runs])
    return list(dict.fromkeys(found))  # a replaced frame may deviate again


def _spikes(curve: Curve, sensitivity: float) -> list[tuple[int, int, float, float]]:
    """The first frame and the end of each spike, its deviation (m) and its score."""
    steps = curve.steps()
    # Most curves have no step that is long enough, and need no median.
    if len(steps) < 4 or steps.max() * 4 * sensitivity <= LEAST:
        return []
    level = np.maximum(LEAST, TIMES * local_median(curve.roughness(), curve.rate))
    values = curve.continuous()
    candidates: list[tuple[float, float, int, int]] = []
    for length in range(1, max(3, round(SECONDS * curve.rate)) + 1):
        # The step to the first frame and the one from the last are at least half of the deviation.
        least = level[1 : len(steps) - length + 1] / (4 * sensitivity)
        first = 1 + np.flatnonzero(np.minimum(steps[:-length], steps[length:]) > least)
        first = first[(first >= 2) & (first + length + 1 < len(curve.values))]
        into, out = first - 1, first + length - 1
        turn = np.sum((values[into + 1] - values[into]) * (values[out + 1] - values[out]), axis=-1)
        first = first[turn < SAME_WAY * steps[into] * steps[out]]
        size = _deviation(values, first, length)
        beside = np.maximum(steps[first - 2], steps[first + length])
        inside = steps[first] if length > 1 else 0.0
        score = size / np.maximum(level[first], BESIDE * (beside + inside))
        likely = np.flatnonzero(score > 1 / (2 * sensitivity))
        candidates += [(size[i], score[i], first[i], first[i] + length) for i in likely]
    taken = np.zeros(len(curve.values), bool)
    spikes = []
    for deviation, times, begin, end in sorted(candidates, reverse=True):
        if not taken[begin - 1 : end + 1].any():
            taken[begin:end] = True
            spikes.append((int(begin), int(end), float(deviation), float(times)))
    return spikes


def _that_move(
    motion: Motion, curve: Curve, spikes: list[tuple[int, int, float, float]], sensitivity: float
) -> list[tuple[int, int, float, float]]:
    """The spikes of a curve with which a joint below deviates by `LEAST` from its own cubic; all
    of them if there is no joint below."""
    path, joints = motion.skeleton.path, range(len(motion.skeleton.names))
    below = [joint for joint in joints if curve.joint in path(joint)[curve.is_rotation :]]

    def moves(first: int, end: int) -> bool:
        positions = motion.at(slice(first - 2, end + 2)).positions(below)
        off = _deviation(positions, np.array([2]), end - first).max()
        return bool(off * 2 * sensitivity > LEAST)

    return [spike for spike in spikes if not below or moves(*spike[:2])]


def _deviation(values: np.ndarray, first: np.ndarray, length: int) -> np.ndarray:
    """How far runs of values (F, …, C) that begin at the frames `first` (N,) are from their cubics,
    (N, …) in metres."""
    deviations = []
    for inside in (0, length - 1):
        off = values[first + inside].copy()
        for time, weight in _weights(length, inside + 1):
            off -= weight * values[first - 1 + time]
        deviations.append(np.linalg.norm(off, axis=-1))
    return np.minimum(*deviations)


def _weights(length: int, at: int) -> list[tuple[int, float]]:
    """Of a cubic the times -1, 0, length + 1 and length + 2, and the weights of its values there at
    the time `at`."""
    times = np.array([-1, 0, length + 1, length + 2])
    return [
        (int(time), float(np.prod([(at - x) / (time - x) for x in times if x != time])))
        for time in times
    ]
