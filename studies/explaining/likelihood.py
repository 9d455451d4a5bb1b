"""A finder by one score: the file is truth plus a short list of events, and the list with the
lowest cost is the explanation.

The cost of a motion is -log p of its second differences a_t (`Channel.between`, in metres at the
end of the limb), with a Student-t of ν degrees of freedom in three dimensions, less its constant:

    ρ(a) = (ν + 3) / 2 · log(1 + |a|² / (ν s²)),
    s_t  = median |a| + share · median |d| + floor,

over half a second around t, d being the steps from frame to frame. An event explains some of the
second differences. Its gain is the cost before less the cost after, less what its parameters cost:

- spike: up to n frames are replaced by a smooth curve
- turned, root offset: two steps, over L frames each, that undo each other: three parameters
- hold: a rotation repeats while others move
- arm held: a wrist stays at a place of the world while the shoulder moves
- cut: steps of most joints at one frame

Hips and shoulders have, besides, the evidence of `limb_residual`: what the other joints predict, by
a regression learned from the rest of the take. A turn explains residuals by a constant.

Search is greedy, for each channel: the event with the largest gain is taken and subtracted, and the
rest is searched again. The confidence of an event is σ(α + β · gain), with α and β of its kind.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.channels import Channel
from numpy_cae.cleanup.kinds import ROOT
from numpy_cae.cleanup.view import View
from numpy_cae.motion import JOINTS, RATE, Motion
from numpy_cae.motion.masks import runs
from numpy_cae.motion.quaternions import angle, rotate
from studies.explaining.limb_residual import limb_residual

FREEDOM = 3.0
"""ν of the module's equation."""
SPEED_SHARE = 0.05
"""The share of the speed of the module's equation."""
FLOOR_METRES = 5e-4
FLOOR_METRES_A_SECOND_SQUARED = 1.0
"""The floor of s is the first plus what this acceleration (m/s²) moves in the time of a frame."""
SCALE_SECONDS = 0.25
"""The medians of s are over this time (s) before and after."""
SPIKE_SECONDS = 0.06
"""A spike lasts up to three frames, or up to this time (s)."""
RAMPS = (1, 2, 3, 5, 9)
"""A turn or an offset begins, and ends, within one of these numbers of steps."""
LEAST_END_NATS = 2.0
"""An end of a turn that no regression speaks for explains at least this much."""
CORE_SECONDS = (0.4, 0.7, 1.1, 1.6)
"""Windows of the residuals of the regression last so long (s)."""
MOST_WINDOWS = 3
"""The windows of the regression with the largest gains are refined."""
LEAST_WINDOW_NATS = 3.0
"""These explain at least this much."""
MOST_ENDS = 40
"""Of each channel this many ends are paired, those that explain most."""
MOST_PAIRS = 30
"""This many pairs are looked at closely."""
RAMP_NATS_A_SECOND = 40.0
"""A second in which a turn begins or ends costs this much: joints bend and stretch as slowly."""
TURN_SECONDS = (0.1, 3.0)
"""A turn lasts between these times (s)."""
USUAL_SHARE = 0.2
"""The vector of an end may be off by this share of the usual way in its time."""
FREE_NATS = 2.0
"""A frame that an event replaces costs this much."""
INDEPENDENT_RATE = 30.0
RATE_POWER = 0.5
"""A frame counts (`INDEPENDENT_RATE` / rate) ** `RATE_POWER`, and at most 1."""
SMALL_METRES = 0.1
"""An event costs the square of this by its size (m)."""
STEP_RANGE = 3.0
"""A turn is a vector within a ball of this radius (rad), an offset within this radius (m)."""
LEAST_RESIDUAL_METRES = 0.03
"""The scale of the residuals of the regression is their median plus this (m)."""
REGRESSION_WEIGHT = 0.15
"""The weight of a frame of the regression at thirty frames a second: its residuals in neighbouring
frames are alike."""
LEAVES = [joint for joint in JOINTS if joint.endswith(("head", "wrist", "toe"))]
"""These joints move none of the twenty, and are not looked at for turns."""
HOLD_SECONDS = 0.2
HOLD_NATS = 1.0
"""A hold lasts at least this time (s), and explains this much for each thirtieth of a second."""
STRAIGHT_DEGREES = 2.0
"""A knee or an elbow that is turned by less than this (°) is at its limit."""
KINK_NATS = 4.0
"""A hold begins, and ends, at a frame whose second difference costs more than this."""
HELD_METRES = 1e-5
"""A rotation repeats where its steps are shorter than this (m)."""
WORLD_SHARE = 0.05
"""A wrist stays in the world where its steps are below this share of those of its shoulder."""
WORLD_NATS = 2.0
"""What each thirtieth of a second explains in which a wrist stays in the world."""
ACTIVITY_QUANTILE = 0.7
"""The scale of a frame is multiplied by this quantile, over the channels, of |a| / s around."""
PLACE_METRES = 0.005
AIM_METRES = 0.02
"""A wrist is at a place within the first of these (m); the line of the arm that points at it misses
it by at most the second."""
CUT_PRICE = 4.0
CUT_CAP = 10.0
LEAST_CUT_NATS = 20.0
CLIP_SECONDS = 0.3
"""A cut explains for each channel up to the second of these, less the first, and in all at least
the third; a clip lasts at least the fourth (s)."""
MOST_ROUNDS = 8
"""A channel has at most this many events."""

NO_VECTORS = np.zeros((2, 3))
CALIBRATION: dict[str, tuple[float, float]] = {
    "spike": (-11.8, 0.57),
    "turned": (-6.6, 0.60),
    "root offset": (-6.2, 0.81),
    "hold": (-5.1, 0.86),
    "arm held": (-6.5, 0.80),
    "cut": (-8.0, 0.20),
}
"""α and β of each kind: a logistic regression, with a weak prior, on planted damage in 24 takes of
CMU, where few kinds have a wrong finding; of turns one outlier was left out, and those of cuts were
set by hand, since 55_04 at 60 Hz, without a cut, has a gain of 50."""


class Event(NamedTuple):
    """An event of one channel: its kind, its first frame and the frame after its last, what it
    explains (nats), the steps over which it begins and ends, and of a turn or an offset the vectors
    (2, 3) at its begin and at its end, in metres, in the parent's frame or in the joint's own."""

    kind: str
    first: int
    end: int
    gain: float
    rise: int = 1
    fall: int = 1
    vectors: np.ndarray = NO_VECTORS
    in_parent: bool = False

    def vectors_at(self, frames: np.ndarray) -> np.ndarray:
        """The vector in some frames, times its share there, (n, 3)."""
        rises_at = self.first - 1
        share = np.minimum((frames - rises_at) / self.rise, (self.end - frames) / self.fall)
        way = ((frames - rises_at) / (self.end - rises_at))[:, None]
        vector = (1 - way) * self.vectors[0] + way * self.vectors[1]
        return np.clip(share, 0.0, 1.0)[:, None] * vector


class Ends(NamedTuple):
    """The possible ends of turns over some steps, by the last frame before them: what each explains
    (F,), its vectors in the joint's own frame and in its parent's (F, 3), and how far these may be
    off (F,); -inf where there is none."""

    gain: np.ndarray
    own: np.ndarray
    parent: np.ndarray
    spread: np.ndarray


class Curve:
    """A channel with the costs of its second differences, and for a hip or a shoulder the residuals
    of the regression in both frames (`limb_residual`), in metres."""

    def __init__(self, channel: Channel, residuals: Sequence[np.ndarray] = ()):
        self.channel = channel
        self.rate = channel.rate
        frames = np.arange(len(channel.values))
        self.steps = channel.between(frames[:-1], frames[1:])  # (F - 1, 3)
        self.change = np.zeros((len(frames), 3))
        self.change[1:-1] = np.diff(self.steps, axis=0)
        self.size = np.linalg.norm(self.change, axis=1)
        floor = FLOOR_METRES + FLOOR_METRES_A_SECOND_SQUARED / self.rate**2
        speed = np.linalg.norm(self.steps, axis=1)
        around = max(2, round(SCALE_SECONDS * self.rate))
        self.scale = moving_median(self.size, around) + floor
        self.scale += SPEED_SHARE * moving_median(np.append(speed, speed[-1]), around)
        self.weight = weight_of(self.rate)
        self.cost = self.weight * cost_of(self.size / self.scale)  # at each frame
        self.residuals = residuals

    @cached_property
    def total(self) -> np.ndarray:
        """The sums of the costs before each frame, (F + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.cost)])

    @cached_property
    def ends(self) -> dict[int, Ends]:
        """The possible ends of turns, by the steps over which they last."""
        return {ramp: ends_of(self, ramp) for ramp in RAMPS}

    @cached_property
    def residual_scales(self) -> list[float]:
        """The scales of the residuals of the regression."""
        sizes = [np.linalg.norm(residual, axis=1) for residual in self.residuals]
        return [float(np.median(size)) + LEAST_RESIDUAL_METRES for size in sizes]

    def scale_by(self, activity: np.ndarray) -> None:
        """Multiply the scale of each frame by a factor."""
        self.scale = self.scale * activity
        self.cost = self.weight * cost_of(self.size / self.scale)

    def explain(self, first: int, end: int) -> None:
        """Take the second differences at the frames from `first` to before `end` as explained."""
        self.cost[max(first, 0) : end] = 0.0
        for name in ("total", "ends"):
            vars(self).pop(name, None)

    def cost_between(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """The cost of the second differences at the frames from `first` to `last`."""
        return self.total[last + 1] - self.total[first]


def cost_of(ratio: np.ndarray) -> np.ndarray:
    """ρ of the module's equation, of |a| / s."""
    return (FREEDOM + 3) / 2 * np.log1p(ratio**2 / FREEDOM)


def weight_of(rate: float) -> float:
    """The weight of a frame: at high rates, accelerations of neighbouring frames are alike."""
    return float(min(1.0, (INDEPENDENT_RATE / rate) ** RATE_POWER))


def size_price(metres: np.ndarray | float) -> np.ndarray:
    """What an event costs that moves the end of a limb by so much."""
    return (SMALL_METRES / np.maximum(metres, 1e-3)) ** 2


def moving_median(values: np.ndarray, around: int) -> np.ndarray:
    """The median of values (N,) over some frames before and after each."""
    padded = np.pad(values, around, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * around + 1)
    return np.median(windows, axis=1)


def find_spikes(curve: Curve) -> list[Event]:
    """Runs of frames that a smooth curve replaces."""
    steps = curve.steps
    events = []
    longest = max(3, round(SPIKE_SECONDS * curve.rate))
    for length in range(1, longest + 1):
        # The run begins at frame `first`; two frames before it and after it are right.
        first = np.arange(2, len(curve.cost) - length - 1)
        if not len(first):
            continue
        across = curve.channel.between(first - 1, first + length) / (length + 1)
        bend_in = 2 * (across - steps[first - 2]) / (length + 2)
        bend_out = 2 * (steps[first + length] - across) / (length + 2)
        scale = curve.scale[first]
        after = cost_of(np.linalg.norm(bend_in, axis=1) / scale)
        after += cost_of(np.linalg.norm(bend_out, axis=1) / scale)
        gain = curve.cost_between(first - 1, first + length) - curve.weight * (
            after + FREE_NATS * length
        )
        size = np.minimum(
            np.linalg.norm(curve.channel.between(first - 1, first) - across, axis=1),
            np.linalg.norm(
                curve.channel.between(first + length - 1, first + length) - across, axis=1
            ),
        )
        gain -= size_price(size)
        for i in local_maxima(gain):
            events.append(Event("spike", int(first[i]), int(first[i]) + length, float(gain[i])))
    return events


def ends_of(curve: Curve, ramp: int) -> Ends:
    """The possible ends of turns that last for some steps."""
    frames = len(curve.cost)
    ends = Ends(
        np.full(frames, -np.inf), np.zeros((frames, 3)), np.zeros((frames, 3)), np.ones(frames)
    )
    at = np.arange(1, frames - ramp - 1)
    if not len(at):
        return ends
    usual = ramp * (curve.steps[at - 1] + curve.steps[at + ramp]) / 2
    vector = curve.channel.between(at, at + ramp) - usual
    frames = at[:, None] + np.arange(ramp + 1)
    change = curve.change[frames]  # (N, ramp + 1, 3)
    scale = curve.scale[frames]
    u = np.arange(ramp + 1) / ramp
    after = []
    for share in (u, u * u * (3 - 2 * u)):
        bend = np.diff(np.concatenate([[0.0], share, [1.0]]), n=2)
        left = change - bend[:, None] * vector[:, None]
        after.append(cost_of(np.linalg.norm(left, axis=2) / scale).sum(axis=1))
    ends.gain[at] = curve.cost_between(at, at + ramp) - curve.weight * np.minimum(*after)
    ends.own[at] = vector
    ends.parent[at] = in_parent(curve.channel, at, vector)
    ends.spread[at] = curve.scale[at] * ramp + USUAL_SHARE * np.linalg.norm(usual, axis=1)
    return ends


def in_parent(channel: Channel, frames: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors of turns in the joint's own frame as ones in its parent's; of places unchanged."""
    if not channel.is_rotation:
        return vectors
    return channel.lever * rotate(channel.values[frames], vectors / channel.lever)


def local_maxima(gain: np.ndarray) -> np.ndarray:
    """Where a gain is at least that of its neighbours."""
    padded = np.pad(gain, 1, constant_values=-np.inf)
    return np.flatnonzero((gain >= padded[:-2]) & (gain >= padded[2:]) & np.isfinite(gain))


def find_turns(curve: Curve) -> list[Event]:
    """Pairs of ends that undo each other, and what the regression shows."""
    if curve.channel.is_rotation and curve.channel.name in LEAVES:
        return []
    at, ramp = strongest_ends(curve)
    ends = [curve.ends[steps] for steps in ramp.tolist()]
    gain = np.array([x.gain[i] for x, i in zip(ends, at, strict=True)])
    own = np.array([x.own[i] for x, i in zip(ends, at, strict=True)]).reshape(-1, 3)
    parent = np.array([x.parent[i] for x, i in zip(ends, at, strict=True)]).reshape(-1, 3)
    lasts = at[None] - (at + ramp)[:, None]
    shortest, longest = (seconds * curve.rate for seconds in TURN_SECONDS)
    both = gain[:, None] + gain[None]
    size = np.minimum.outer(np.linalg.norm(own, axis=1), np.linalg.norm(own, axis=1))
    off = np.minimum(
        np.linalg.norm(own[:, None] + own[None], axis=-1),
        np.linalg.norm(parent[:, None] + parent[None], axis=-1),
    )
    both[(lasts < shortest) | (lasts > longest) | (off > size)] = -np.inf
    events = []
    for pair in np.argsort(-both, axis=None)[:MOST_PAIRS]:
        i, j = np.unravel_index(pair, both.shape)
        if np.isfinite(both[i, j]):
            events.append(turn_of(curve, int(at[i]), int(ramp[i]), int(at[j]), int(ramp[j])))
    for first, end in windows_of(curve):
        events.append(refine(curve, first, end))
    return events


def strongest_ends(curve: Curve) -> tuple[np.ndarray, np.ndarray]:
    """The last frames before the ends that explain most, and their steps."""
    begins = []
    for ramp, ends in curve.ends.items():
        for at in local_maxima(ends.gain):
            if ends.gain[at] > LEAST_END_NATS:
                begins.append((float(ends.gain[at]), int(at), ramp))
    begins = sorted(begins, reverse=True)[:MOST_ENDS]
    at = np.array([at for _, at, _ in begins], int)
    return at, np.array([ramp for _, _, ramp in begins], int)


def turn_of(curve: Curve, rises_at: int, rise: int, falls_at: int, fall: int) -> Event:
    """The turn or the offset with two ends, and its gain."""
    channel = curve.channel
    begin = curve.ends[rise]
    close = curve.ends[fall]
    radius = STEP_RANGE * (channel.lever if channel.is_rotation else 1.0)
    spread = float(np.hypot(begin.spread[rises_at], close.spread[falls_at]))
    mismatch = []
    vectors = []
    for first, second in ((begin.own, close.own), (begin.parent, close.parent)):
        mismatch.append(float(np.linalg.norm(first[rises_at] + second[falls_at])))
        vectors.append(np.stack([first[rises_at], -second[falls_at]]))
    frame = int(np.argmin(mismatch))
    size = float(np.linalg.norm(vectors[frame].mean(axis=0)))
    gain = float(begin.gain[rises_at] + close.gain[falls_at])
    gain -= float(cost_of(np.array(mismatch[frame] / spread)))
    gain -= 3 * np.log(radius / spread) + float(size_price(size))
    gain -= RAMP_NATS_A_SECOND * (rise + fall - 2) / curve.rate
    if mismatch[frame] > size:
        gain = -np.inf
    if curve.residuals:
        gain += explained_residual(curve, rises_at, rise, falls_at, fall)
    kind = "turned" if channel.is_rotation else "root offset"
    return Event(kind, rises_at + 1, falls_at + fall, gain, rise, fall, vectors[frame], frame == 1)


def explained_residual(curve: Curve, rises_at: int, rise: int, falls_at: int, fall: int) -> float:
    """What a turn explains of the residuals of the regression, in the better one of both frames."""
    frames = np.arange(rises_at, falls_at + fall + 1)
    share = np.minimum((frames - rises_at) / rise, (falls_at + fall - frames) / fall)
    share = np.clip(share, 0.0, 1.0)[:, None]
    gains = []
    for residual, scale in zip(curve.residuals, curve.residual_scales, strict=True):
        inside = residual[frames]
        vector = np.median(inside[share[:, 0] == 1], axis=0)
        before = cost_of(np.linalg.norm(inside, axis=1) / scale)
        after = cost_of(np.linalg.norm(inside - share * vector, axis=1) / scale)
        gains.append(float(np.sum(before - after)))
    return max(gains) * REGRESSION_WEIGHT * RATE / curve.rate


def windows_of(curve: Curve) -> list[tuple[int, int]]:
    """The windows in which a constant turn explains most of the residuals of the regression: the
    last frames before their ends."""
    windows: list[tuple[float, int, int]] = []
    step = max(1, round(curve.rate / RATE))
    for residual, scale in zip(curve.residuals, curve.residual_scales, strict=True):
        sparse = residual[::step]
        for seconds in CORE_SECONDS:
            length = round(seconds * curve.rate / step)
            if length >= len(sparse) - 6:
                continue
            inside = np.lib.stride_tricks.sliding_window_view(sparse, length, axis=0)[::2]
            vector = np.median(inside, axis=2, keepdims=True)
            before = cost_of(np.linalg.norm(inside, axis=1) / scale).sum(axis=1)
            after = cost_of(np.linalg.norm(inside - vector, axis=1) / scale).sum(axis=1)
            gain = REGRESSION_WEIGHT * (before - after) * RATE * step / curve.rate
            for i in local_maxima(gain):
                first = max(2 * step * i, 2)
                windows.append((float(gain[i]), int(first), int(first + length * step)))
    windows.sort(reverse=True)
    chosen: list[tuple[int, int]] = []
    for gain, first, end in windows:
        overlaps = any(first < other_end and other < end for other, other_end in chosen)
        is_inside = end < len(curve.cost) - max(RAMPS) - 2
        if gain > LEAST_WINDOW_NATS and is_inside and not overlaps and len(chosen) < MOST_WINDOWS:
            chosen.append((first, end))
    return chosen


def refine(curve: Curve, rises_at: int, falls_at: int) -> Event:
    """The best turn whose ends are near those of a window: first one end is moved, then the
    other."""
    around = max(2, round(curve.rate / 5))
    stride = max(1, round(curve.rate / 30))
    best = turn_of(curve, rises_at, 1, falls_at, 1)
    rise = 1
    fall = 1
    for _ in range(2):
        for shift in range(-around, around + 1, stride):
            for ramp in RAMPS:
                at = rises_at + shift
                if at < 1 or at + ramp >= falls_at:
                    continue
                event = turn_of(curve, at, ramp, falls_at, fall)
                if event.gain > best.gain:
                    best = event
        rises_at, rise = best.first - 1, best.rise
        for shift in range(-around, around + 1, stride):
            for ramp in RAMPS:
                at = falls_at + shift
                if at <= rises_at + rise or at + ramp >= len(curve.cost) - 1:
                    continue
                event = turn_of(curve, rises_at, rise, at, ramp)
                if event.gain > best.gain:
                    best = event
        falls_at, fall = best.end - best.fall, best.fall
        around = stride
        stride = 1
    return best


def find_holds(curve: Curve, others_move: np.ndarray) -> list[Event]:
    """Runs of steps in which a rotation repeats while most others move, with what its ends
    explain; not at a value that the file repeats elsewhere, such as the limit of a knee."""
    if not curve.channel.is_rotation:
        return []
    is_still = np.linalg.norm(curve.steps, axis=1) < HELD_METRES
    events = []
    for first, end in runs(is_still).tolist():
        if end - first < HOLD_SECONDS * curve.rate or not others_move[first:end].mean() > 0.5:
            continue
        if first == 0 or recurs(curve, first, end):
            continue
        gain = HOLD_NATS * (end - first) * RATE / curve.rate
        reach = max(RAMPS)
        at = np.arange(max(first - reach, 0), first + 1)
        gain += curve.cost[at].sum() - len(at)
        at = np.arange(end, min(end + reach, len(curve.cost)))
        gain += curve.cost[at].sum() - len(at)
        begin, after = with_onsets([curve], first, end + 1)
        events.append(Event("hold", begin, after, float(gain)))
    return events


def with_onsets(curves: Sequence[Curve], first: int, end: int) -> tuple[int, int]:
    """The first frame and the frame after the last of a hold, with the frames over which it begins
    and ends: up to the outermost kink of some channels."""
    reach = max(RAMPS)
    cost = np.sum([curve.cost for curve in curves], axis=0)
    is_kink = cost > KINK_NATS * curves[0].weight
    before = np.flatnonzero(is_kink[max(first - reach, 0) : first])
    after = np.flatnonzero(is_kink[end : end + reach])
    if len(before):
        first = max(first - reach, 0) + int(before[0]) + 1
    if len(after):
        end = end + int(after[-1])
    return first, end


def recurs(curve: Curve, first: int, end: int) -> bool:
    """Whether the value of a rotation that repeats from one frame to another comes back, or the
    knee or the elbow is straight."""
    frames = np.arange(len(curve.cost))
    off = np.linalg.norm(curve.channel.between(np.full(len(frames), first), frames), axis=1)
    away = (frames < first - 2) | (frames > end + 2)
    is_straight = curve.channel.name.endswith(("knee", "elbow")) and (
        angle(curve.channel.values[first]) < np.radians(STRAIGHT_DEGREES)
    )
    return bool(is_straight or np.count_nonzero(off[away] < HELD_METRES) > 1)


def find_world_holds(view: View) -> Iterator[tuple[str, Event]]:
    """Arms whose wrist stays at a place of the world while the shoulder moves, with the frames
    beside them in which the arm points at the place, and does not reach it."""
    for side in ("left", "right"):
        column = JOINTS.index(f"{side}_shoulder")
        arm = view.body[:, [column, column + 2]]
        steps = np.linalg.norm(np.diff(arm, axis=0), axis=-1)
        is_still = (steps[:, 1] < WORLD_SHARE * steps[:, 0]) & (steps[:, 0] > 0.03 / view.rate)
        covered = 0
        for first, end in runs(is_still).tolist():
            if end - first < max(2, HOLD_SECONDS / 3 * view.rate) or first < covered:
                continue
            aims = aims_at(arm, arm[first : end + 1, 1].mean(axis=0))
            aims[first : end + 1] = True
            start, covered = next(run for run in runs(aims).tolist() if run[0] <= first < run[1])
            gain = WORLD_NATS * (end - first) * RATE / view.rate
            gain += (covered - start - end + first) * RATE / view.rate
            yield f"{side}_shoulder", Event("arm held", int(start), int(covered), gain)


def arm_joints(shoulder: str) -> list[str]:
    """The shoulder and the elbow of an arm, by the name of the shoulder."""
    return [shoulder, shoulder.replace("shoulder", "elbow")]


def aims_at(arm: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Whether an arm (frames, shoulder and wrist, 3) ends at a place, or points at it and is
    stretched (frames,)."""
    way = arm[:, 1] - arm[:, 0]
    reach = np.linalg.norm(way, axis=1)
    to_place = place - arm[:, 0]
    along = np.sum(to_place * way, axis=1) / np.maximum(reach, 1e-9)
    off = np.linalg.norm(to_place - along[:, None] * way / np.maximum(reach, 1e-9)[:, None], axis=1)
    is_there = np.linalg.norm(arm[:, 1] - place, axis=1) < PLACE_METRES
    return is_there | ((off < AIM_METRES) & (along > reach) & (reach > 0.95 * reach.max()))


def find_cuts(curves: Sequence[Curve]) -> list[tuple[int, float]]:
    """The frames at which most channels step, and what a cut there explains."""
    gains = []
    for curve in curves:
        pair = curve.cost[1:-1] + curve.cost[2:]  # of the frames t - 1 and t, for t from 2 on
        gains.append(np.minimum(pair, CUT_CAP) - CUT_PRICE)
    total = np.sum(gains, axis=0)
    shortest = CLIP_SECONDS * curves[0].rate
    cuts = []
    for at in local_maxima(total):
        if total[at] > 0 and shortest <= at + 2 <= len(total) - shortest:
            cuts.append((int(at) + 2, float(total[at])))
    return cuts


def activity_of(curves: Sequence[Curve]) -> np.ndarray:
    """How much faster than usual most channels change at each frame, at least 1: in a real jerk all
    do."""
    ratios = np.array([curve.size / curve.scale for curve in curves])
    typical = np.quantile(ratios, ACTIVITY_QUANTILE, axis=0)
    widest = np.lib.stride_tricks.sliding_window_view(np.pad(typical, 2, mode="edge"), 5)
    return np.maximum(widest.max(axis=1), 1.0)


def explain_curve(curve: Curve, others_move: np.ndarray, least: float) -> list[Event]:
    """The events of a channel, the largest gain first: each is subtracted before the next."""
    events: list[Event] = []
    for _ in range(MOST_ROUNDS):
        candidates = find_spikes(curve) + find_turns(curve) + find_holds(curve, others_move)
        candidates = [event for event in candidates if not is_taken(event, events)]
        best = max(candidates, key=lambda event: event.gain, default=None)
        if best is None or best.gain < least:
            break
        events.append(best)
        if best.kind in ("turned", "root offset"):
            curve.explain(best.first - 1, best.first + best.rise)
            curve.explain(best.end - best.fall, best.end + 1)
            for residual in curve.residuals:
                residual[best.first - 1 : best.end + 1] = 0.0
        else:
            margin = max(RAMPS) if best.kind == "hold" else 1
            curve.explain(best.first - margin, best.end + margin)
    return events


def is_taken(event: Event, events: Sequence[Event]) -> bool:
    """Whether an event shares an end with one that is there, or is a spike or a hold as it is."""
    for earlier in events:
        if earlier.kind == event.kind and earlier.first < event.end and event.first < earlier.end:
            return True
    return False


def explain(motion: Motion, least: float = 0.0) -> tuple[list[tuple[str, Event]], list]:
    """The events of a motion with the joints, and the frames of cuts with what they explain."""
    view = View(motion)
    channels = []
    for channel in view.channels:
        if channel.channel == ROOT or (channel.is_rotation and channel.name in JOINTS):
            channels.append(channel)
    curves = []
    for channel in channels:
        residuals: list[np.ndarray] = []
        if channel.is_rotation and channel.name.endswith(("hip", "shoulder")):
            residuals = [channel.lever * r for r in limb_residual(view, channel.name) or ()]
        curves.append(Curve(channel, residuals))
    if len(view) < 8 or not curves:
        return [], []
    cuts = find_cuts(curves)
    still = [np.linalg.norm(curve.steps, axis=1) < HELD_METRES for curve in curves]
    others_move = np.mean(still, axis=0) < 0.5
    by_name = {curve.channel.name: curve for curve in curves if curve.channel.is_rotation}
    held = []
    for name, event in find_world_holds(view):
        arm = [by_name[joint] for joint in arm_joints(name) if joint in by_name]
        first, end = with_onsets(arm, event.first, event.end) if arm else (event.first, event.end)
        held.append((name, event._replace(first=first, end=end)))
    events = list(held)
    activity = activity_of(curves)
    for curve in curves:
        curve.scale_by(activity)
    for curve in curves:
        for cut, gain in cuts:
            if gain > LEAST_CUT_NATS:
                curve.explain(cut - 1, cut + 1)
        for name, event in held:
            if curve.channel.name in arm_joints(name):
                curve.explain(event.first - max(RAMPS), event.end + max(RAMPS))
        for event in explain_curve(curve, others_move, least):
            events.append((curve.channel.name, event))
    return events, cuts
