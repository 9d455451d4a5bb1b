"""Spikes: a rotation or a place that jumps away and back within a few frames.

A run of n frames is compared with the cubic through the two frames before it and the two after it.
Its deviation is the smaller one of its first and its last frame: that of a run which is longer than
the spike, or beside it, is nearly 0. Of runs that touch each other, the one with the largest
deviation is the spike. It is removed and the rest is searched again, as a spike also distorts the
cubics beside it.

The joints below must deviate from their cubics too: several rotations may jump together and cancel
each other, so that the body does not move.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.motion.hole_curves import over_holes, rotations_over_holes
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import rotate
from numpy_cae.repair.curves import Curve, Segment, body_size, curves_of, least_jump, local_median
from numpy_cae.repair.finding import Finding, confidence

LONGEST_SECONDS = 0.1
"""LONGEST_SECONDS: a spike lasts at most this time (s), or a frame."""
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
ROUNDS = 4
"""ROUNDS: spikes are removed and looked for again at most this often."""


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
            spikes = _that_move(motion, curve, _spikes(curve, sensitivity), sensitivity)
            if not spikes:
                break
            for spike in spikes:
                why = f"{curve.amount(spike.size)} from the frames before and after"
                frames = (spike.first, spike.end - 1)
                sure = confidence(spike.score)
                found.append(Finding(curve.name, frames, curve.spike_kind, why, 0.0, sure))
            curve = _interpolated(curve, spikes)
    return list(dict.fromkeys(found))  # a replaced frame may deviate again


def longest_spike(rate: float) -> int:
    """The frames of the longest spike at a rate."""
    return max(1, round(LONGEST_SECONDS * rate))


def _least(rate: float) -> float:
    """The least deviation of a spike at a rate, metres."""
    return max(least_jump(rate), LEAST_ACCELERATION / rate**2)


def _spikes(curve: Curve, sensitivity: float) -> list[Segment]:
    """Of the runs of a curve that may be spikes, those with the largest deviations, no two of which
    touch each other."""
    candidates = sorted(_candidates(curve, sensitivity), key=_deviation_first, reverse=True)
    taken = np.zeros(len(curve.values), bool)
    spikes = []
    for run in candidates:
        if not taken[run.first - 1 : run.end + 1].any():
            taken[run.first : run.end] = True
            spikes.append(run)
    return spikes


def _deviation_first(run: Segment) -> tuple[float, float, int, int]:
    return run.size, run.score, run.first, run.end


def _candidates(curve: Curve, sensitivity: float) -> list[Segment]:
    """The runs of a curve that deviate from the frames around them more than noise and the motion
    do."""
    steps = curve.steps()  # steps[t] is from frame t to frame t + 1
    # Most curves have no step that is long enough, and need no median.
    least = _least(curve.rate)
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


def _that_move(
    motion: Motion, curve: Curve, spikes: list[Segment], sensitivity: float
) -> list[Segment]:
    """The spikes of a curve with which a point that the joint carries leaves its own cubic too."""
    moving = []
    for spike in spikes:
        around = motion.at(slice(spike.first - 2, spike.end + 2))
        positions = _carried(around, curve) / body_size(motion)
        off = _deviation(positions, np.array([2]), len(spike))[0]
        beside = np.linalg.norm(positions[[1, -1]] - positions[[0, -2]], axis=-1).max(axis=0)
        least = np.maximum(_least(motion.rate), NEIGHBOUR_RATIO * beside)
        if not len(off) or (off * 2 * sensitivity > least).any():
            moving.append(spike)
    return moving


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


def _interpolated(curve: Curve, segments: Sequence[Segment]) -> Curve:
    """A curve interpolated over segments."""
    missing = np.zeros((len(curve.values), 1), bool)
    for segment in segments:
        missing[segment.first : segment.end] = True
    over = rotations_over_holes if curve.is_rotation else over_holes
    return replace(curve, values=over(curve.values[:, None], missing, curve.rate)[:, 0])
