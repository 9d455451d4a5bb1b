"""Legs that are turned for a while, by a turn that begins and ends within a few frames.

A hip whose rotation R is turned by a constant turn Q = exp(w), in its own frame or in its parent's,
has

    R'_t = R_t exp(s_t w)    or    R'_t = exp(s_t w) R_t

where s rises from 0 to 1 within a few frames, and later falls back. A kick changes a rotation as
fast. Therefore each of these is asked, and each has a threshold. The first two, of the file, and
the last two, of the manifold, may make up for each other a little (`WEAKEST_RATIO`):

- undone, the turn leaves smaller accelerations while s rises and falls (`ROUGH_SHARE`)
- the rest of the joints moves little meanwhile (`REST_SHARE`), the knee too (`BEND_SHARE`)
- of the difference from what the manifold fills in for the limb, R̂⁻¹ R' or R' R̂⁻¹ as a rotation
  vector, s w explains nearly all (`UNEXPLAINED_SHARE`): a kick is not a constant difference
- the knee is about as bent as the manifold has it (`CHILD_SHARE`)

All is computed at about thirty frames a second. Arms are not looked at: people wave as a turned arm
moves.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.finding import Finding, confidence
from numpy_cae.cleanup.holes import Holes
from numpy_cae.cleanup.kinds import LIMB_TURNED
from numpy_cae.cleanup.view import View
from numpy_cae.manifold.filling import complete_from_curves
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, RATE, Motion
from numpy_cae.motion.hole_curves import interpolate_rotations
from numpy_cae.motion.joints import LIMBS, SIDES, joint_mask
from numpy_cae.motion.quaternions import from_vector, inverse, product, to_vector

LAGS_SECONDS = np.array([1, 2, 3, 4, 5, 7, 9]) / RATE
"""A turn begins, and ends, within one of these times (s)."""
SHORTEST_TURN_SECONDS = 0.25
"""A turn stays for at least this time (s)."""
LONGEST_TURN_SECONDS = 3.4
"""A turn ends at most this time (s) after it began."""
LEAST_CHANGE_DEGREES = 20.0
"""A rotation changes by more than this (°) where a turn begins, and at its end."""
UNUSUAL_RATIO = 1.5
"""This change is more than this many times the 80% quantile of the changes of the rotation within
the same time."""
CLOSING_SHARE = 0.6
"""The two changes undo each other but for this share of the smaller one."""
SAME_SHARE = 0.6
"""Two possible turns are alternatives if they share this part of their frames."""
MOST_ALTERNATIVES = 60
"""This many alternatives are compared, those of the largest changes first."""
MOST_TURNS = 2000
"""Of each limb this many possible turns are looked at, those of the largest changes: an hour of
noise has a hundred times as many."""
MOST_ASKED = 40
"""The manifold is asked at most this often about a limb."""
SURE_LEVEL = 0.75
"""Evidence below this share of its thresholds is certain, or below its thresholds if the turn
begins and ends quickly: the legs of dances reach 0.78, and turn for longer."""
QUICK_SECONDS = 0.1
"""A turn begins, or ends, quickly if within this time (s)."""
MOST_LEVEL = 1.3
"""Evidence within this factor of its thresholds is proposed; if the file's own evidence is not, the
manifold is not asked."""
WEAKEST_RATIO = 1.6
"""Strong evidence of the file makes up for weak evidence of the manifold, and the other way round,
but no share may exceed its threshold by more than this factor."""
CONTEXT_SECONDS = 2.5
"""The manifold fills in a limb from the motion up to this time (s) around."""
ROUGH_SHARE = 0.95
"""Without the turn, the root mean square acceleration of the rotation while the turn begins and
ends is at most this share of that with it (geometric mean of both ends)."""
REST_SHARE = 0.4
"""Meanwhile the rest of the joints turns by at most this share of the turn, in the mean."""
BEND_SHARE = 0.7
"""Meanwhile the knee turns by at most this share of the turn."""
UNEXPLAINED_SHARE = 0.25
"""Of the squared difference from the filled limb, the turn leaves at most this share
unexplained."""
CHILD_SHARE = 0.6
"""The knee differs from the filled one by at most this share of the turn."""
TURNED_JOINTS = {f"{side}_hip": LIMBS[f"{side}_leg"] for side in SIDES}
"""The joints that may be turned, and the limbs that they move."""
COMPARED_NAMES = ("hips", "spine", "chest", "shoulder", "elbow", "hip", "knee")
COMPARED = [column for column, name in enumerate(JOINTS) if name.endswith(COMPARED_NAMES)]
"""The joints whose rotations are compared with that of a leg."""


class Turn(NamedTuple):
    """A turn by exp(`vector`) that begins after the frame `first`, is complete from `risen` to
    `falls`, and has ended at the frame `end`."""

    first: int
    risen: int
    falls: int
    end: int
    vector: np.ndarray
    in_parent: bool
    size: float

    def share(self, frames: np.ndarray) -> np.ndarray:
        """s in some frames, (F, 1)."""
        rise = (frames - self.first) / (self.risen - self.first)
        fall = (self.end - frames) / (self.end - self.falls)
        return np.clip(np.minimum(rise, fall), 0.0, 1.0)[:, None]

    def overlap(self, turn: "Turn") -> float:
        """The frames of both turns, as a share of the frames of either."""
        common = min(self.end, turn.end) - max(self.first, turn.first)
        return common / (max(self.end, turn.end) - min(self.first, turn.first))

    def at_frames(self, step: int) -> "Turn":
        """The turn in the frames of a motion of which every `step`-th frame was taken."""
        first, risen, falls, end = (step * frame for frame in self[:4])
        return Turn(first, risen, falls, end, self.vector, self.in_parent, self.size)

    def undo(self, q: np.ndarray, frames: np.ndarray) -> np.ndarray:
        """Rotations (F, 4) in some frames without the turn."""
        back = from_vector(-self.share(frames) * self.vector)
        return product(back, q) if self.in_parent else product(q, back)


def find_limb_turns(view: View, sensitivity: float, manifold: MotionManifold) -> list[Finding]:
    """Findings of the kind "limb turned"; with less evidence they are proposed.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> motion = make_take("walk", 3, seconds=4.0, rate=30.0).motion
    >>> share = np.interp(np.arange(120), [50, 53, 80, 83], [0, 1, 1, 0])[:, None]
    >>> hip = motion.skeleton.index("rfemur")
    >>> turn = from_vector(share * [0.9, 0.0, 0.0])
    >>> motion.rotations[:, hip] = product(motion.rotations[:, hip], turn)
    >>> find_limb_turns(View(motion), 0.5, starter())
    [right_hip: frames 51 to 82: limb turned (...
    """
    sparse, step = view.at_about_thirty()
    motion = sparse.motion
    findings = []
    for name in TURNED_JOINTS:
        accepted: list[Turn] = []
        for turns in islice(_alternatives(motion, name), MOST_ASKED):
            turn, level = _best(motion, manifold, name, turns)
            if level >= MOST_LEVEL or any(turn.overlap(earlier) > 0 for earlier in accepted):
                continue
            accepted.append(turn)
            degrees = np.degrees(np.linalg.norm(turn.vector))
            evidence = (
                f"turns by {degrees:.0f}° and back, and stays so far from what the model fills in"
            )
            frames = (turn.first * step + 1, turn.end * step - 1)
            longer = max(turn.risen - turn.first, turn.end - turn.falls)
            score = (SURE_LEVEL if longer > QUICK_SECONDS * motion.rate else 1.0) / level
            status = "repaired" if score * 2 * sensitivity > 1 else "proposed"
            sure = confidence(score)
            findings.append(Finding(name, frames, LIMB_TURNED.name, evidence, 0.0, sure, status))
    return findings


def mend_limb_turns(view: View, findings: Sequence[Finding], manifold: MotionManifold) -> Motion:
    """The motion without the turns of findings; where a turn begins and ends, the rotation is
    interpolated. A finding whose frames are those of no turn is not mended."""
    motion = view.motion
    sparse_view, step = view.at_about_thirty()
    sparse = sparse_view.motion
    rotations = motion.rotations.copy()
    for finding in findings:
        joint = rig_of(motion).joints[JOINTS.index(finding.joint)]
        first = (finding.frames[0] - 1) // step
        end = -(-(finding.frames[1] + 1) // step)
        possible = _turns(sparse.rotations[:, joint], sparse.rate)
        turns = [x for x in possible if max(abs(x.first - first), abs(x.end - end)) <= 1]
        if not turns:
            continue
        turn, _ = _best(sparse, manifold, finding.joint, turns)
        turn = turn.at_frames(step)
        frames = np.arange(turn.first, min(turn.end + 1, len(motion)))
        rotations[frames, joint] = turn.undo(rotations[frames, joint], frames)
        missing = np.zeros((len(motion), 1), bool)
        missing[max(turn.first, 1) : turn.risen] = True
        missing[turn.falls + 1 : min(turn.end + 1, len(motion) - 1)] = True
        rotations[:, [joint]] = interpolate_rotations(rotations[:, [joint]], missing, motion.rate)
    return replace(motion, rotations=rotations)


def _best(
    motion: Motion, manifold: MotionManifold, name: str, turns: list[Turn]
) -> tuple[Turn, float]:
    """Of some alternatives the one with the most evidence, and its level: the geometric mean of the
    levels of the file and of the manifold. Below 1 the evidence is strong enough."""
    of_model = _levels_of_model(motion, manifold, name, turns)
    of_file = [_level_in_file(motion, name, turn) for turn in turns]
    both = np.sqrt(np.multiply(of_model, of_file))
    levels = np.maximum(both, np.maximum(of_model, of_file) / WEAKEST_RATIO)
    best = int(np.argmin(levels))
    return turns[best], float(levels[best])


def _alternatives(motion: Motion, name: str) -> Iterator[list[Turn]]:
    """The possible turns of a joint, in groups of alternatives, those of the largest changes
    first."""
    q = motion.rotations[:, rig_of(motion).joints[JOINTS.index(name)]]
    turns = sorted(_turns(q, motion.rate), key=lambda turn: -turn.size)[:MOST_TURNS]
    while turns:
        best = turns[0]
        group = [turn for turn in turns if turn.overlap(best) > SAME_SHARE][:MOST_ALTERNATIVES]
        group = [turn for turn in group if _level_in_file(motion, name, turn) < MOST_LEVEL]
        turns = [turn for turn in turns if turn.overlap(best) < SAME_SHARE / 2]
        if group:
            yield group


def _turns(q: np.ndarray, rate: float) -> Iterator[Turn]:
    """All pairs of fast changes of a rotation (F, 4) that undo each other."""
    if len(q) <= LAGS_SECONDS.max() * rate + 2:  # a short file
        return
    for in_parent in (False, True):
        begins, lags, changes, ratios = _fast_changes(q, rate, in_parent)
        sizes = np.linalg.norm(changes, axis=1)
        for i, first in enumerate(begins.tolist()):
            risen = first + int(lags[i])
            earliest = risen + SHORTEST_TURN_SECONDS * rate - 1
            near = (begins >= earliest) & (begins <= first + LONGEST_TURN_SECONDS * rate)
            remaining = np.linalg.norm(changes[i] + changes[near], axis=1)
            remaining /= np.minimum(sizes[i], sizes[near])
            closing = remaining < CLOSING_SHARE
            ends = np.flatnonzero(near)[closing].tolist()
            for j, share in zip(ends, remaining[closing], strict=True):
                vector = (changes[i] - changes[j]) / 2
                size = min(ratios[i], ratios[j]) * (1 - share)
                falls = int(begins[j])
                end = falls + int(lags[j])
                yield Turn(first, risen, falls, end, vector, in_parent, float(size))


def _fast_changes(q: np.ndarray, rate: float, in_parent: bool) -> list[np.ndarray]:
    """Where a rotation changes fast: the frames before, the lags in frames, the rotation vectors of
    the changes, and their ratios to a usual change."""
    fast = []
    for lag in np.unique(np.maximum(np.round(LAGS_SECONDS * rate), 1).astype(int)).tolist():
        change = _between(q[:-lag], q[lag:], in_parent)
        size = np.linalg.norm(change, axis=1)
        usual = max(np.quantile(size, 0.8), np.radians(3.0))
        padded = np.pad(size, 1)
        peak = (size >= padded[:-2]) & (size >= padded[2:])
        peak &= size > max(np.radians(LEAST_CHANGE_DEGREES), UNUSUAL_RATIO * usual)
        at = np.flatnonzero(peak)
        fast.append((at, np.full(len(at), lag), change[at], size[at] / usual))
    return [np.concatenate(parts) for parts in zip(*fast, strict=True)]


def _between(q: np.ndarray, r: np.ndarray, in_parent: bool) -> np.ndarray:
    """The rotation vectors (F, 3) from rotations q to r, in their own frames or their parent's."""
    return to_vector(product(r, inverse(q)) if in_parent else product(inverse(q), r))


def _level_in_file(motion: Motion, name: str, turn: Turn) -> float:
    """The largest of the shares of the file's evidence, each divided by its threshold."""
    joints = rig_of(motion).joints
    column = JOINTS.index(name)
    q = motion.rotations[:, joints[column]]
    rough = []
    rest = []
    bend = []
    size = np.linalg.norm(turn.vector)
    for first, end in ((turn.first, turn.risen), (turn.falls, turn.end)):
        frames = np.arange(max(first - 2, 0), min(end + 3, len(q)))
        after = _acceleration(turn.undo(q[frames], frames))
        rough.append(after / max(_acceleration(q[frames]), 1e-9))
        ends = motion.rotations[[first, min(end, len(q) - 1)]][:, joints]
        turned = np.linalg.norm(_between(ends[0], ends[1], False), axis=1) / size
        rest.append(np.mean([turned[x] for x in COMPARED if x not in (column, column + 1)]))
        bend.append(turned[column + 1])
    shares = (np.sqrt(np.prod(rough)), max(rest), max(bend))
    return float(np.max(np.divide(shares, (ROUGH_SHARE, REST_SHARE, BEND_SHARE))))


def _acceleration(q: np.ndarray) -> float:
    """The root of the sum of the squared accelerations of rotations (F, 4), in radians a frame²."""
    return float(np.linalg.norm(np.diff(_between(q[:-1], q[1:], False), axis=0)))


def _levels_of_model(
    motion: Motion, manifold: MotionManifold, name: str, turns: list[Turn]
) -> list[float]:
    """For each of some alternatives the larger of the shares that the manifold gives, each divided
    by its threshold."""
    first = max(min(turn.first for turn in turns) - 1, 0)
    end = min(max(turn.end for turn in turns) + 2, len(motion))
    margin = round(CONTEXT_SECONDS * motion.rate)
    start = max(first - margin, 0)
    near = motion.at(slice(start, end + margin))
    hole = slice(first - start, end - start)
    holes = Holes(Body(near, manifold.lengths), joint_mask(len(near), TURNED_JOINTS[name], hole))
    strength = np.ones(holes.mask.shape)
    completed = holes.move_to(complete_from_curves(manifold, holes.features, holes.mask, strength))
    joint, child = rig_of(motion).joints[JOINTS.index(name) :][:2]
    expected = completed.rotations[hole]
    present = near.rotations[hole]
    of_child = np.linalg.norm(_between(expected[:, child], present[:, child], False), axis=1)
    difference = [
        _between(expected[:, joint], present[:, joint], in_parent) for in_parent in (False, True)
    ]
    levels = []
    for turn in turns:
        share = turn.share(np.arange(first, end))
        x = difference[turn.in_parent]
        unexplained = np.sum((x - share * turn.vector) ** 2) / max(np.sum(x**2), 1e-9)
        bent = np.sqrt(np.mean(of_child[share[:, 0] == 1] ** 2)) / np.linalg.norm(turn.vector)
        levels.append(float(max(unexplained / UNEXPLAINED_SHARE, bent / CHILD_SHARE)))
    return levels
