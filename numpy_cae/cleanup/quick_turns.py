"""A turned limb: a hip or a shoulder is turned by a constant turn Q for a while.

The turn begins and ends within a few frames, in its own frame or in its parent's, s rising from 0
to 1 and falling again:

    R'_t = R_t exp(s_t q)    or    R'_t = exp(s_t q) R_t

Whether there is one is asked as a price. Between its ends a turn does not change the accelerations
of the joint. At its ends there are large ones, which no motion has. With a_t the second differences
of the rotation, in metres at the end of the limb, a motion costs -log p(a) under Student's t with ν
degrees of freedom in three dimensions (its constant left out),

    ρ(a) = (ν + 3) / 2 · log(1 + |a|² / (ν s²)),
    s_t  = median |a| + share · median |d| + floor

over a second around, d being the steps from frame to frame. s is larger where the other joints jerk
in the same frame. The gain of a turn is what both ends cost less than with it, and less than with
its parameters: q, that the two ends do not quite undo each other, the time in which it begins and
ends, and that it is small. Turns are taken in the order of their gains.

Turns that begin and end within a step are left to `displacements`. Kicks and punches begin and end
within a tenth of a second as turns do: slower ones are left to `limb_turns`, which asks the
manifold.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.channels import Channel, local_median
from numpy_cae.cleanup.displacements import LEAST_TURN_DEGREES
from numpy_cae.cleanup.finding import Finding
from numpy_cae.cleanup.kinds import LIMB_TURNED_QUICKLY, TURNED_JOINTS
from numpy_cae.cleanup.view import View
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.hole_curves import interpolate_rotations
from numpy_cae.motion.quaternions import from_vector, product, rotate

FREEDOM = 3.0
"""ν of the module's equation."""
SPEED_SHARE = 0.05
"""The share of the speed of the module's equation."""
FLOOR_METRES = 5e-4
"""The floor of s is this (m), and what `FLOOR_METRES_A_SECOND_SQUARED` adds."""
FLOOR_METRES_A_SECOND_SQUARED = 1.0
"""This acceleration (m/s²) in the time of a frame is added to the floor of s."""
ACTIVITY_QUANTILE = 0.7
"""s is multiplied by this quantile, over the rotations of the twenty joints, of |a| / s within two
frames, where that is above 1."""
INDEPENDENT_RATE = 30.0
"""At rates above this, the costs of frames are multiplied by √(this / rate): neighbouring frames
are alike."""
RAMPS = (1, 2, 3, 5, 9)
"""A turn begins, and ends, within one of these numbers of steps; which of them are quick is
`LONGEST_RAMP_SECONDS`."""
LONGEST_RAMP_SECONDS = 0.085
"""A turn begins, and ends, within this time (s): in 400 clips of synthetic kicks, punches, runs and
jumps at 24 to 120 frames a second one end at least of what looks like a turn is slower."""
SHORTEST_SECONDS = 0.25
"""A turn stays for at least this time (s); punches are shorter."""
LONGEST_SECONDS = 3.0
"""A turn lasts at most this time (s)."""
LEAST_END = 2.0
"""An end of a turn explains at least this much."""
MOST_ENDS = 40
"""Within `BLOCK_SECONDS` this many ends of a joint are paired, those that explain most."""
MOST_PAIRS = 30
"""This many pairs are looked at closely, those whose ends explain most."""
USUAL_SHARE = 0.2
"""The vector of an end may be off by this share of the usual way in its time."""
WIDEST_TURN = 3.0
"""The vector of a turn is anywhere within this (rad)."""
SMALL_METRES = 0.1
"""A turn that moves the end of the limb by a distance d costs (this / d)²."""
RAMP_COST = 40.0
"""Each second in which a turn begins or ends costs this: joints bend and stretch as slowly."""
CERTAINTY = (-9.6, 0.6)
"""The confidence of a turn of a gain g is 1 / (1 + exp(-a - b g)), chosen on takes of CMU: of 24
damaged ones the logistic regression has a slope of 0.6. In clips without damage the largest gain is
12.8 at onsets of any length; turns whose onset is in truth longer than here have up to 14."""
LEAST_CONFIDENCE = 0.2
"""Turns below this confidence are not proposed."""
BLOCK_SECONDS = 6.0
"""A long motion is looked at in blocks of this time (s)."""
AROUND_SECONDS = 4.0
"""A block is seen with this time (s) before and after it."""
LEAST_FRAMES = 24
"""Shorter motions are not looked at."""


class Ends(NamedTuple):
    """Possible ends of turns.

    Parameters
    ----------
    frame, steps : (N,) arrays of int
        The last frame before the end, and the steps over which it lasts.
    gain : (N,) array of float
        What the end explains.
    own, parent : (N, 3) arrays of float
        The vector of the turn in the joint's own frame and in its parent's, metres.
    spread : (N,) array of float
        How far the vector may be off, metres.
    """

    frame: np.ndarray
    steps: np.ndarray
    gain: np.ndarray
    own: np.ndarray
    parent: np.ndarray
    spread: np.ndarray


class Turn(NamedTuple):
    """A turn of a joint.

    Parameters
    ----------
    first, end : int
        Its first frame, and the frame after its last.
    rise, fall : int
        The steps over which it begins and ends.
    gain : float
        How much less the motion costs without it.
    vectors : (2, 3) array of float
        q at its begin and at its end, radians.
    in_parent : bool
        Whether it is a turn in the frame of the parent.
    """

    first: int
    end: int
    rise: int
    fall: int
    gain: float
    vectors: np.ndarray
    in_parent: bool

    def share(self, frames: np.ndarray) -> np.ndarray:
        """s in some frames, (F,)."""
        rising = (frames - self.first + 1) / self.rise
        falling = (self.end - frames) / self.fall
        return np.clip(np.minimum(rising, falling), 0.0, 1.0)

    def undo(self, q: np.ndarray, frames: np.ndarray) -> np.ndarray:
        """Rotations (F, 4) in some frames without the turn."""
        way = ((frames - self.first + 1) / (self.end - self.first + 1))[:, None]
        vector = (1 - way) * self.vectors[0] + way * self.vectors[1]
        back = from_vector(-self.share(frames)[:, None] * vector)
        return product(back, q) if self.in_parent else product(q, back)

    def touches(self, turn: "Turn") -> bool:
        """Whether both have frames in common, or next to each other."""
        return self.first <= turn.end and turn.first <= self.end

    def later(self, frames: int) -> "Turn":
        """The turn some frames later."""
        return self._replace(first=self.first + frames, end=self.end + frames)


class Costs:
    """What the accelerations of a channel cost.

    Parameters
    ----------
    channel : Channel
        A rotation of F frames.
    """

    def __init__(self, channel: Channel):
        self.channel = channel
        self.rate = channel.rate
        frames = np.arange(len(channel.values))
        self.steps = channel.between(frames[:-1], frames[1:])
        self.change = np.zeros((len(frames), 3))
        self.change[1:-1] = np.diff(self.steps, axis=0)
        self.size = np.linalg.norm(self.change, axis=1)
        speed = np.linalg.norm(self.steps, axis=1)
        self.scale = local_median(self.size, self.rate)
        self.scale += SPEED_SHARE * local_median(np.append(speed, speed[-1]), self.rate)
        self.scale += FLOOR_METRES + FLOOR_METRES_A_SECOND_SQUARED / self.rate**2
        self.weight = min(1.0, np.sqrt(INDEPENDENT_RATE / self.rate))

    def cost(self) -> np.ndarray:
        """The cost of each frame, (F,)."""
        return self.weight * cost_of(self.size / self.scale)


def cost_of(ratio: np.ndarray) -> np.ndarray:
    """ρ of the module's equation, of |a| / s."""
    return (FREEDOM + 3) / 2 * np.log1p(ratio**2 / FREEDOM)


def find_quick_turns(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """Findings of the kind "limb turned quickly"; with less evidence they are proposed.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 3, seconds=4.0, rate=30.0).motion
    >>> share = np.interp(np.arange(120), [50, 52, 80, 82], [0, 1, 1, 0])[:, None]
    >>> hip = motion.skeleton.index("rfemur")
    >>> turn = from_vector(share * [0.9, 0.0, 0.0])
    >>> motion.rotations[:, hip] = product(motion.rotations[:, hip], turn)
    >>> find_quick_turns(View(motion))
    [right_hip: frames 51 to 81: limb turned quickly (...
    """
    findings = []
    for channel, turn in find_turns(view):
        sure = confidence_of(turn.gain)
        if sure < LEAST_CONFIDENCE:
            continue
        status = "repaired" if sure >= 1 - sensitivity else "proposed"
        size = channel.lever * float(np.linalg.norm(turn.vectors.mean(axis=0)))
        evidence = f"turns by {channel.amount(size)} and back"
        frames = (turn.first, turn.end - 1)
        finding = Finding(
            channel.name, frames, LIMB_TURNED_QUICKLY.name, evidence, 0.0, sure, status
        )
        findings.append(finding)
    return findings


def mend_quick_turns(view: View, findings: Sequence[Finding]) -> Motion:
    """The motion without the turns of findings; where a turn begins and ends, the rotation is
    interpolated. A finding whose frames are those of no turn is not mended."""
    motion = view.motion
    rotations = motion.rotations.copy()
    for channel, turn in find_turns(view):
        if not any(_is_of(finding, channel, turn) for finding in findings):
            continue
        frames = np.arange(turn.first, turn.end)
        rotations[frames, channel.joint] = turn.undo(rotations[frames, channel.joint], frames)
        missing = np.zeros((len(motion), 1), bool)
        missing[turn.first : turn.first + turn.rise - 1] = True
        missing[turn.end - turn.fall + 1 : turn.end] = True
        columns = [channel.joint]
        rotations[:, columns] = interpolate_rotations(rotations[:, columns], missing, motion.rate)
    return replace(motion, rotations=rotations)


def _is_of(finding: Finding, channel: Channel, turn: Turn) -> bool:
    """Whether a finding is of a turn."""
    off = max(abs(finding.frames[0] - turn.first), abs(finding.frames[1] + 1 - turn.end))
    return finding.joint == channel.name and off <= 1


def confidence_of(gain: float) -> float:
    """The probability of a turn with a gain, by `CERTAINTY`."""
    return float(1 / (1 + np.exp(-np.clip(CERTAINTY[0] + CERTAINTY[1] * gain, -50, 50))))


def find_turns(view: View) -> list[tuple[Channel, Turn]]:
    """The turns of hips and shoulders that explain more than they cost, with their channels, in the
    order of their frames."""
    block = max(LEAST_FRAMES, view.frames(BLOCK_SECONDS))
    around = view.frames(AROUND_SECONDS)
    turns: list[tuple[Channel, Turn]] = []
    for start in range(0, len(view), block):
        near = slice(max(start - around, 0), start + block + around)
        for channel, turn in find_turns_in(view, near):
            later = turn.later(near.start)
            is_new = not any(
                known is channel and later.touches(earlier) for known, earlier in turns
            )
            if start <= later.first < start + block and is_new:
                turns.append((channel, later))
    return sorted(turns, key=lambda pair: pair[1][:2])


def find_turns_in(view: View, near: slice) -> Iterator[tuple[Channel, Turn]]:
    """The turns in some frames of a motion, counted from the first of these, with the channels of
    the motion."""
    channels = [x for x in view.channels if x.is_rotation and x.name in JOINTS]
    limbs = [channel for channel in channels if channel.name in TURNED_JOINTS]
    if len(range(len(view))[near]) < LEAST_FRAMES or not limbs:
        return
    costs = [Costs(replace(channel, values=channel.values[near])) for channel in channels]
    activity = activity_of(costs)
    for channel, of_channel in zip(channels, costs, strict=True):
        if channel not in limbs:
            continue
        of_channel.scale = of_channel.scale * activity
        for turn in turns_of(of_channel):
            yield channel, turn


def activity_of(costs: Sequence[Costs]) -> np.ndarray:
    """By how much most joints are more jerky than usual at each frame (F,), at least 1: a movement
    has all joints, damage one."""
    ratios = np.array([of_channel.size / of_channel.scale for of_channel in costs])
    typical = np.quantile(ratios, ACTIVITY_QUANTILE, axis=0)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(typical, 2, mode="edge"), 5)
    return np.maximum(windows.max(axis=1), 1.0)


def turns_of(costs: Costs) -> list[Turn]:
    """The quick turns of a channel that explain more than they cost, no two of which touch, the
    largest gain first. Slow ones compete with them, and so do those within a step."""
    turns: list[Turn] = []
    for turn in sorted(pairs_of(costs), key=lambda candidate: -candidate.gain):
        if turn.gain > 0 and not any(turn.touches(earlier) for earlier in turns):
            turns.append(turn)
    longest = LONGEST_RAMP_SECONDS * costs.rate
    quick = []
    for turn in turns:
        slower = max(turn.rise, turn.fall)
        if 1 < slower <= longest and is_large(turn):
            quick.append(turn)
    return quick


def is_large(turn: Turn) -> bool:
    """Whether a turn is one of more than `LEAST_TURN_DEGREES`."""
    size = np.linalg.norm(turn.vectors, axis=1)
    return bool(np.degrees(size.min()) > LEAST_TURN_DEGREES)


def find_ends(costs: Costs) -> Ends:
    """The ends of turns that explain most."""
    parts = []
    total = np.concatenate([[0.0], np.cumsum(costs.cost())])
    for steps in RAMPS:
        frame = np.arange(1, len(costs.size) - steps - 1)
        if not len(frame):
            continue
        usual = steps * (costs.steps[frame - 1] + costs.steps[frame + steps]) / 2
        vector = costs.channel.between(frame, frame + steps) - usual
        gain = (
            total[frame + steps + 1] - total[frame] - _cost_with_turn(costs, frame, vector, steps)
        )
        padded = np.pad(gain, 1, constant_values=-np.inf)
        best = np.flatnonzero((gain >= padded[:-2]) & (gain >= padded[2:]) & (gain > LEAST_END))
        frame = frame[best]
        vector = vector[best]
        q = costs.channel.values[frame]
        parent = costs.channel.lever * rotate(q, vector / costs.channel.lever)
        spread = costs.scale[frame] * steps
        spread = spread + USUAL_SHARE * np.linalg.norm(usual[best], axis=1)
        parts.append(Ends(frame, np.full(len(frame), steps), gain[best], vector, parent, spread))
    ends = Ends(*(np.concatenate(values) for values in zip(*parts, strict=True)))
    order = np.argsort(-ends.gain)[:MOST_ENDS]
    return Ends(*(values[order] for values in ends))


def _cost_with_turn(costs: Costs, frame: np.ndarray, vector: np.ndarray, steps: int) -> np.ndarray:
    """The cost of the frames of ends (N,) without a turn by `vector` (N, 3) over some steps, whose
    share rises as u or as 3u² - 2u³."""
    frames = frame[:, None] + np.arange(steps + 1)
    u = np.arange(steps + 1) / steps
    smallest = np.full(len(frame), np.inf)
    for share in (u, u * u * (3 - 2 * u)):
        bend = np.diff(np.concatenate([[0.0], share, [1.0]]), n=2)
        left = costs.change[frames] - bend[:, None] * vector[:, None]
        ratio = np.linalg.norm(left, axis=2) / costs.scale[frames]
        smallest = np.minimum(smallest, cost_of(ratio).sum(axis=1))
    return costs.weight * smallest


def pairs_of(costs: Costs) -> Iterator[Turn]:
    """The pairs of ends that undo each other, with their gains by the accelerations."""
    ends = find_ends(costs)
    lever = costs.channel.lever
    lasts = ends.frame[None] - (ends.frame + ends.steps)[:, None]
    both = ends.gain[:, None] + ends.gain[None]
    both[lasts < SHORTEST_SECONDS * costs.rate] = -np.inf
    both[lasts > LONGEST_SECONDS * costs.rate] = -np.inf
    size = np.linalg.norm(ends.own, axis=1)
    off = np.minimum(
        np.linalg.norm(ends.own[:, None] + ends.own[None], axis=2),
        np.linalg.norm(ends.parent[:, None] + ends.parent[None], axis=2),
    )
    both[off > np.minimum(size[:, None], size[None])] = -np.inf
    for pair in np.argsort(-both, axis=None)[:MOST_PAIRS]:
        i, j = np.unravel_index(pair, both.shape)
        if both[i, j] == -np.inf:
            break
        gains = []
        for vector in (ends.own, ends.parent):
            mismatch = np.linalg.norm(vector[i] + vector[j])
            moved = np.linalg.norm(vector[i] - vector[j]) / 2
            spread = np.hypot(ends.spread[i], ends.spread[j])
            gain = both[i, j] - cost_of(mismatch / spread)
            gain -= 3 * np.log(WIDEST_TURN * lever / spread) + (SMALL_METRES / moved) ** 2
            gain -= RAMP_COST * (ends.steps[i] + ends.steps[j] - 2) / costs.rate
            gains.append(float(gain))
        in_parent = gains[1] > gains[0]
        vector = ends.parent if in_parent else ends.own
        yield Turn(
            first=int(ends.frame[i]) + 1,
            end=int(ends.frame[j] + ends.steps[j]),
            rise=int(ends.steps[i]),
            fall=int(ends.steps[j]),
            gain=max(gains),
            vectors=np.stack([vector[i], -vector[j]]) / lever,
            in_parent=in_parent,
        )
