"""Spikes: a rotation or a place that jumps away and back within a few frames.

A run of n frames is compared with the cubic through the two frames before it and the two after it.
Its deviation is the smaller one of its first and its last frame: that of a run which is longer than
the spike, or beside it, is nearly 0. Of runs that touch each other, the one with the largest
deviation is the spike. It is removed and the rest is searched again, as a spike also distorts the
cubics beside it. The joints below must deviate from their cubics too: several rotations may jump
together and cancel each other, so that the body does not move.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.cleanup.curves import Curve, Segment, body_size, curves_of, least_jump, local_median
from numpy_cae.cleanup.finding import Finding, confidence
from numpy_cae.motion.hole_curves import interpolate_rotations, interpolate_values
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import rotate

LONGEST_SPIKE_SECONDS = 0.1
"""LONGEST_SPIKE_SECONDS: a spike lasts at most this time (s), or a frame."""
SPIKE_METRES_A_SECOND_SQUARED = 60.0
"""SPIKE_METRES_A_SECOND_SQUARED: a spike deviates by more than the shortest jump
(`curves.least_jump`: 8 cm at 30 frames a second, 5 cm from 38 on), and by more than this
acceleration (m/s²) moves a joint in the time of a frame, which is more below 28 frames a second: a
hand or foot that strikes reaches it."""
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
    return max(least_jump(rate), SPIKE_METRES_A_SECOND_SQUARED / rate**2)


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
    positions = carried(around, curve) / body_size(motion)
    off = _deviation(positions, np.array([2]), len(spike))[0]
    beside = np.linalg.norm(positions[[1, -1]] - positions[[0, -2]], axis=-1).max(axis=0)
    least = np.maximum(_least_spike(motion.rate), NEIGHBOUR_RATIO * beside)
    return not len(off) or bool((off * 2 * sensitivity > least).any())


def carried(motion: Motion, curve: Curve) -> np.ndarray:
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
    over = interpolate_rotations if curve.is_rotation else interpolate_values
    return replace(curve, values=over(curve.values[:, None], missing, curve.rate)[:, 0])
