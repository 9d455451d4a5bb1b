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

from numpy_cae.cleanup.channels import Candidate, Channel, least_jump, local_median
from numpy_cae.cleanup.finding import Finding, confidence
from numpy_cae.cleanup.kinds import SPIKE, kind_of_place
from numpy_cae.cleanup.view import View
from numpy_cae.motion.hole_curves import interpolate_rotations, interpolate_values
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import rotate

LONGEST_SPIKE_SECONDS = 0.1
"""A spike lasts at most this time (s), or a frame."""
SPIKE_METRES_A_SECOND_SQUARED = 60.0
"""A spike deviates by more than this acceleration (m/s²) moves a joint in the time of a frame: a
hand or foot that strikes reaches it. It also deviates by more than the shortest jump
(`channels.least_jump`: 8 cm at 30 frames a second, 5 cm from 38 on), which is less below 28 frames
a second."""
NOISE_RATIO = 9.0
"""A spike deviates by more than this times the noise, which is the median over a second of the
deviations of single frames."""
NEIGHBOUR_RATIO = 1.5
"""A spike deviates by more than this times the sum of the larger step just before or after it and
the first step within it."""
RETURN_SHARE = 0.5
"""The steps to a spike and from it are both longer than this share of its deviation: it goes there
and back. Before a joint that jumps and stays, one of them is short."""
SAME_WAY_COSINE = 0.5
"""A run is no spike if the cosine of the angle between the steps to it and from it is at least
this: the joint passes through, as the elbow of a runner at 24 frames a second does."""
MOST_REMOVALS = 4
"""Spikes of a channel are removed and looked for again at most this often."""


def find_spikes(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """The spikes of each joint of the rig; those of bones have kind "length", of the root's place
    "root elsewhere".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> find_spikes(View(motion))
    [left_elbow: frame 30: spike (...]
    """
    findings = []
    for channel in view.channels:
        kind = SPIKE if channel.is_rotation else kind_of_place(channel.channel)
        for _ in range(MOST_REMOVALS):
            spikes = _spikes(view, channel, sensitivity)
            for spike in spikes:
                evidence = f"{channel.amount(spike.size)} from the frames before and after"
                frames = (spike.first, spike.end - 1)
                sure = confidence(spike.score)
                findings.append(Finding(channel.name, frames, kind.name, evidence, 0.0, sure))
            if not spikes:
                break
            channel = _interpolate(channel, spikes)
    return list(dict.fromkeys(findings))  # a replaced frame may deviate again


def longest_spike(rate: float) -> int:
    """The frames of the longest spike at a rate."""
    return max(1, round(LONGEST_SPIKE_SECONDS * rate))


def _least_spike(rate: float) -> float:
    """The least deviation of a spike at a rate, metres."""
    return max(least_jump(rate), SPIKE_METRES_A_SECOND_SQUARED / rate**2)


def _spikes(view: View, channel: Channel, sensitivity: float) -> list[Candidate]:
    """Of the runs of a channel that may be spikes, those with the largest deviations, no two of
    which touch each other, and of these those that move the body."""
    candidates = _candidates(channel, sensitivity)
    candidates.sort(key=lambda run: (run.size, run.score, run), reverse=True)
    is_spike = np.zeros(len(channel.values), bool)
    spikes = []
    for run in candidates:
        if not is_spike[run.first - 1 : run.end + 1].any():
            is_spike[run.first : run.end] = True
            spikes.append(run)
    return [run for run in spikes if _moves_the_body(view, channel, run, sensitivity)]


def _candidates(channel: Channel, sensitivity: float) -> list[Candidate]:
    """The runs of a channel that deviate from the frames around them more than noise and the motion
    do."""
    steps = channel.steps()  # steps[t] is from frame t to frame t + 1
    # Most channels have no step that is long enough, and need no median.
    least = _least_spike(channel.rate)
    if len(steps) < 4 or steps.max() * 4 * sensitivity <= least:
        return []
    noise = local_median(channel.roughness(), channel.rate)
    level = np.maximum(least, NOISE_RATIO * noise)
    values = channel.continuous()
    candidates = []
    for length in range(1, longest_spike(channel.rate) + 1):
        first = np.arange(2, len(values) - length - 1)  # with two frames before and after the run
        # The step to the first frame and the one from the last are at least half of the deviation.
        smaller_step = np.minimum(steps[first - 1], steps[first + length - 1])
        first = first[smaller_step > level[first] / (4 * sensitivity)]
        end = first + length
        step_in = values[first] - values[first - 1]
        step_out = values[end] - values[end - 1]
        cosine = np.sum(step_in * step_out, axis=-1)
        turns_back = cosine < SAME_WAY_COSINE * steps[first - 1] * steps[end - 1]
        first = first[turns_back]
        end = end[turns_back]
        size = _deviation(values, first, length)
        next_to_run = np.maximum(steps[first - 2], steps[end])
        within = steps[first] if length > 1 else 0.0
        score = size / np.maximum(level[first], NEIGHBOUR_RATIO * (next_to_run + within))
        returns = np.minimum(steps[first - 1], steps[end - 1]) > RETURN_SHARE * size
        for i in np.flatnonzero(returns & (score > 1 / (2 * sensitivity))):
            run = Candidate(int(first[i]), int(end[i]), float(score[i]), float(size[i]))
            candidates.append(run)
    return candidates


def _moves_the_body(view: View, channel: Channel, spike: Candidate, sensitivity: float) -> bool:
    """Whether a point that the joint moves leaves its own cubic with a spike, too."""
    around = view.motion.at(slice(spike.first - 2, spike.end + 2))
    positions = positions_moved_by(around, channel) / view.size
    off = _deviation(positions, np.array([2]), len(spike))[0]
    next_to_spike = np.linalg.norm(positions[[1, -1]] - positions[[0, -2]], axis=-1).max(axis=0)
    least = np.maximum(_least_spike(view.rate), NEIGHBOUR_RATIO * next_to_spike)
    return not len(off) or bool((off * 2 * sensitivity > least).any())


def positions_moved_by(motion: Motion, channel: Channel) -> np.ndarray:
    """The positions of the joints that a channel moves, or of the end of its bone where it moves
    none, (frames, N, 3) in metres."""
    skeleton = motion.skeleton
    below = []
    for joint in range(len(skeleton.names)):
        path = skeleton.path(joint)
        above = path[1:] if channel.is_rotation else path  # a rotation does not move its own joint
        if channel.joint in above:
            below.append(joint)
    end = skeleton.end_sites.get(channel.joint)
    if below or end is None:
        return motion.positions(below)
    positions, rotations = motion.forward_kinematics([channel.joint])
    tip = rotate(rotations[:, channel.joint], np.asarray(end))
    return (positions[:, channel.joint] + tip)[:, None]


def _deviation(values: np.ndarray, first: np.ndarray, length: int) -> np.ndarray:
    """How far runs of values (F, …, C) that begin at the frames `first` (N,) are from their cubics,
    (N, …) in metres."""
    deviations = []
    times = np.array([-1, 0, length + 1, length + 2])  # of the frames of a cubic; the run is from 1
    for at in (1, length):
        off = values[first - 1 + at].copy()
        for time in times:
            rest = times[times != time]
            off -= np.prod((at - rest) / (time - rest)) * values[first - 1 + time]
        deviations.append(np.linalg.norm(off, axis=-1))
    return np.minimum(*deviations)


def _interpolate(channel: Channel, runs: Sequence[Candidate]) -> Channel:
    """A channel interpolated over runs of frames."""
    missing = np.zeros((len(channel.values), 1), bool)
    for run in runs:
        missing[run.first : run.end] = True
    interpolate = interpolate_rotations if channel.is_rotation else interpolate_values
    values = interpolate(channel.values[:, None], missing, channel.rate)[:, 0]
    return replace(channel, values=values)
