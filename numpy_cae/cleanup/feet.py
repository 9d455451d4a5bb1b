"""Feet that stand still, on the floor.

A foot stands while its toe is low and slow. The place where it stands is the median of the toe over
that time, at the height at which toes stand in this motion. The displacement from the toe to that
place fades out before and after (`EASE_SECONDS`). The root takes the mean displacement of both
feet, filtered (`PATH_HERTZ`), so that the legs change little; each leg takes the rest by its own
two bones, which keep their lengths (`motion.fit.bend_limb`). All metres are those of a body of
usual size (`curves.usual_body`).

The knee of a leg that becomes straight within a frame pops. So a leg approaches its full length L
only exponentially (soft inverse kinematics: A. Nicholas, softimageblog.com/archives/108). With d_0
the distance from hip to ankle before, and d that with which the foot is at its place, it becomes

    a + (L - a) (1 - exp(-(d - a) / (L - a)))  where d > a = max(d_0, (1 - s) L),  else d

with s = `SOFT_SHARE`. A leg that does not get longer is changed by nothing of this.

Many estimators from video give poses about a root that stands still. Let v_t be the step of the
hips from frame t to t + 1, and u_t the step with which the toe of the lower foot would stand still.
Where Σ‖v_t‖ < FOLLOWING_SHARE · Σ‖u_t‖ the root does not follow the feet. Then its path is the sum
of the medians of u_t over `CALM_SECONDS`, filtered (`PATH_HERTZ`). If the feet make no steps
(`STEPS_METRES`), its path holds the mean of both toes at one place. In height, it keeps the lower
toe at one height.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.curves import body_size, sliding, usual_body, usual_toes
from numpy_cae.cleanup.finding import BODY, Finding, confidence, is_path
from numpy_cae.cleanup.jumps import SHARP, jump_levels
from numpy_cae.mocap.retargeting.body import body_positions
from numpy_cae.mocap.retargeting.to_rig import retarget
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.contacts import FEET
from numpy_cae.motion.filters import butterworth, median_of
from numpy_cae.motion.fit import bend_limb
from numpy_cae.motion.masks import runs, widen_runs

TOES = [JOINTS[foot] for foot in FEET]
LEGS = [list(range(toe - 3, toe + 1)) for toe in FEET]
"""LEGS: hip, knee, ankle and toe of both legs, which follow one another among the twenty joints."""
HANDS = [JOINTS.index("left_wrist"), JOINTS.index("right_wrist")]
CALM_SECONDS = 0.1
"""CALM_SECONDS: steps and speeds are taken over so long before and after a frame (s)."""
PATH_HERTZ = 2.5
"""PATH_HERTZ: the root's path is filtered with this cut-off (Hz). It and
`SLOW_ON_PATH_METRES_A_SECOND` were chosen on takes of CMU and synthetic ones whose root was held
still (docs/lab_book/evidence.md)."""
FOLLOWING_SHARE = 0.4
"""FOLLOWING_SHARE: a root follows the feet if its steps are at least this share of the steps with
which the feet would stand. In 119 takes without damage the share is at least 0.82; in seven files
from video it is at most 0.23."""
HELD_METRES = 0.1
"""HELD_METRES: a root gets no path if both hands stay within this (m) in most frames, as those of a
cyclist do: then the feet need not stand on a floor."""
UPRIGHT_LEGS = 0.7
"""UPRIGHT_LEGS: a root gets a path only if the hips are higher above the lower toe than this times
the length of a leg in most frames."""
STEPS_METRES = 0.3
"""STEPS_METRES: the feet make no steps if 10% and 90% quantiles of the place of one toe relative to
the other are less than this (m) apart along the floor. Of people who stand still and wave, with
noise of 3°, they are at most 0.23 m apart."""


def path_of_root(motion: Motion) -> np.ndarray:
    """What the path of the root lacks, (frames, 3) in metres of a body of usual size: 0 if the root
    follows the feet."""
    body = usual_body(motion)
    toes = body[:, FEET]
    hips = body[:, 0]
    lower_height = toes[..., 1].min(axis=1)
    leg = np.linalg.norm(np.diff(body[0, LEGS[0][:3]], axis=0), axis=-1).sum()
    none = np.zeros((len(motion), 3))
    lies = len(motion) < 3 or np.median(hips[:, 1] - lower_height) < UPRIGHT_LEGS * leg
    if lies or np.linalg.norm(_range(body[:, HANDS]), axis=-1).max() < HELD_METRES:
        return none
    root_steps = np.diff(hips, axis=0)
    lower = (toes[1:, :, 1] + toes[:-1, :, 1]).argmin(axis=1)
    # With these steps of the root the lower toe would stand still.
    asked_steps = root_steps - np.diff(toes, axis=0)[np.arange(len(root_steps)), lower]
    asked = np.linalg.norm(asked_steps, axis=1).sum()
    if np.linalg.norm(root_steps, axis=1).sum() >= FOLLOWING_SHARE * asked:
        return none
    apart = _range(toes[:, 0] - toes[:, 1])
    if np.hypot(apart[0], apart[2]) > STEPS_METRES:
        missing = median_of(asked_steps - root_steps, max(round(CALM_SECONDS * motion.rate), 1))
        path = np.concatenate([none[:1], np.cumsum(missing, axis=0)])
    else:
        path = toes[0].mean(axis=0) - toes.mean(axis=1)
    path[:, 1] = np.median(lower_height) - lower_height
    return butterworth(path, PATH_HERTZ, motion.rate)


def moved_along(motion: Motion, path: np.ndarray) -> Motion:
    """The motion with its whole body moved along a path (frames, 3) of `path_of_root`."""
    return retarget(motion, body_positions(motion) + body_size(motion) * path[:, None])


def _range(x: np.ndarray) -> np.ndarray:
    """The range of values (frames, …) in most frames."""
    return np.subtract(*np.quantile(x, [0.9, 0.1], axis=0))


SLOW_METRES_A_SECOND = 0.5
"""SLOW_METRES_A_SECOND: a toe stands only if it is slower than this (m/s)."""
SLOW_ON_PATH_METRES_A_SECOND = 0.7
"""SLOW_ON_PATH_METRES_A_SECOND: on a path from the feet, a toe stands only if it is slower than
this (m/s)."""
LOW_METRES = 0.05
"""LOW_METRES: a toe stands only if it is at most this high (m) above the height at which toes
stand, the median height of the lower toe where it is slow."""
LEAST_SECONDS = 0.15
"""LEAST_SECONDS: a toe stands for at least this time (s)."""
RESTING_SHARE = 0.5
"""RESTING_SHARE: a root gets a path only if feet on it stand for more than this share of the time:
at least 0.77 in five files whose root stands still, 0.13 and 0.43 in two of noise."""
LEAST_METRES = 0.04
"""LEAST_METRES: the feet of a motion are changed if one of them is further than this (m) from its
place while it stands."""
RESTING_METRES = 1e-4
"""RESTING_METRES: a root that would be moved by less than this (m) stays where it is."""
EASE_SECONDS = 0.2
"""EASE_SECONDS: the displacement of a foot fades in and out in this time (s)."""
SOFT_SHARE = 0.015
"""SOFT_SHARE: s of the module's equation."""
JUMPY_SECONDS = 0.3
"""JUMPY_SECONDS: feet are left as they are if, held, a frame jumps within this time (s)."""
ROUNDS = 4
"""ROUNDS: feet are held at their places at most this often: those that stand then, as long as they
slide less, or those near which no frame jumps."""
STANDING_CENTIMETRES = 1.0
"""STANDING_CENTIMETRES: feet that slide by this speed (cm/s) or less stand."""


class Stance(NamedTuple):
    """The time in which a foot stands: its index in `FEET`, its first frame and its end."""

    foot: int
    first: int
    end: int


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
    found = list[Finding]()
    worst = 0.0
    path = path_of_root(motion)
    if path.any() and _rests(moved_along(motion, path), sliding(motion)):
        why = "the root hardly moves while feet do: its path follows from the feet"
        found = [Finding(BODY, (0, len(motion) - 1), "foot", why)]
        worst = np.inf
        motion = moved_along(motion, path)
    toes, level = _toes(motion)
    for stance in _stances(toes, level, motion.rate, bool(found)):
        toe = toes[stance.first : stance.end, stance.foot]
        away = np.abs(toe - _place(toe, level)).max(axis=0)
        slides, off = 100 * max(away[0], away[2]), 100 * away[1]
        why = f"moves by {slides:.1f} cm, {off:.1f} cm off the floor"
        found.append(Finding(TOES[stance.foot], (stance.first, stance.end - 1), "foot", why))
        worst = max(worst, float(away.max()))
    if worst * 2 * sensitivity <= LEAST_METRES:
        return []
    return [replace(finding, confidence=confidence(worst / LEAST_METRES)) for finding in found]


def mend_feet(motion: Motion, findings: list[Finding]) -> Motion:
    """The motion with the feet of the findings at their places, if they slide less so (`sliding`)
    and no more frames jump; else the motion itself.

    A finding about the body gives the root a path (`is_path`). A foot that stands still does so for
    longer than it seemed: it is looked for again, as long as that helps. Feet near which frames
    would jump are left as they are.
    """
    travels = any(map(is_path, findings))
    best = moved_along(motion, path_of_root(motion)) if travels else motion
    feet = [finding for finding in findings if finding.joint in TOES]
    stances = [Stance(TOES.index(f.joint), f.stretch.start, f.stretch.stop) for f in feet]
    slides = max(sliding(best), STANDING_CENTIMETRES)
    jumps = _jumps(best)
    jumpy = np.zeros(len(motion), bool)
    for _ in range(ROUNDS):
        better = _standing(best, [x for x in stances if not jumpy[x.first : x.end].any()])
        jumps_after = _jumps(better)
        slides_after = sliding(better)
        if jumps_after.sum() > jumps.sum():
            new = (jumps_after & ~jumps)[:, None]
            jumpy |= widen_runs(new, round(JUMPY_SECONDS * motion.rate) + 1)[:, 0]
        elif slides_after < slides:
            best = better
            slides = slides_after
            jumps = jumps_after
            stances = _stances(*_toes(best), motion.rate, travels)
        else:
            break
    sharp = [(jump_levels(x) == SHARP).any(axis=1).sum() for x in (motion, best)]
    return motion if travels and (slides > sliding(motion) or sharp[1] > sharp[0]) else best


def _jumps(motion: Motion) -> np.ndarray:
    """The frames (frames,) in which a joint jumps."""
    return np.asarray((jump_levels(motion) > 0).any(axis=1))


def _rests(motion: Motion, before: float) -> bool:
    """Whether feet that slid with a speed before slide less on a path, and one of them stands in
    most frames: else they do not rest on a floor, and the path is the sum of noise."""
    stands = sum(x.end - x.first for x in _stances(*_toes(motion), motion.rate, travels=True))
    return sliding(motion) < before and stands > RESTING_SHARE * len(motion)


def _stances(toes: np.ndarray, level: float, rate: float, travels: bool) -> list[Stance]:
    """The times in which a foot stands; of both toes (frames, 2, 3)."""
    if len(toes) < 3:
        return []
    frame = np.arange(len(toes))
    around = max(round(CALM_SECONDS * rate), 1)
    before = (frame - around).clip(0)
    after = (frame + around).clip(max=len(toes) - 1)
    speed = np.linalg.norm(toes[after] - toes[before], axis=-1) * rate / (after - before)[:, None]
    slow = speed < (SLOW_ON_PATH_METRES_A_SECOND if travels else SLOW_METRES_A_SECOND)
    stands = slow & (toes[..., 1] < level + LOW_METRES)
    stances = [Stance(foot, *run) for foot in (0, 1) for run in runs(stands[:, foot]).tolist()]
    return [stance for stance in stances if stance.end - stance.first >= LEAST_SECONDS * rate]


def _standing(motion: Motion, stances: list[Stance]) -> Motion:
    """The motion with each foot at its place while it stands."""
    shift, weight = _shifts(motion, stances)
    root = shift.sum(axis=1) / np.maximum(weight.sum(axis=1), 1.0)
    root = butterworth(root, PATH_HERTZ, motion.rate)
    body = usual_body(motion)
    targets = body + root[:, None]
    for foot, (hip, knee, ankle, toe) in enumerate(LEGS):
        targets[:, [ankle, toe]] += (shift[:, foot] - weight[:, foot] * root)[:, None]
        chain = body[:, [hip, knee, ankle]]
        targets[:, [ankle, toe]] += _softened(chain, targets[:, ankle] - targets[:, hip])[:, None]
        targets[:, knee] = bend_limb(targets[:, hip], chain, targets[:, knee], targets[:, ankle])
    changed = weight.any(axis=(1, 2)) | (np.abs(root).max(axis=1) > RESTING_METRES)
    targets *= body_size(motion)
    # Nothing is damaged there: rotations that jump at an end of these frames are the file's.
    start = motion.at(changed)
    return retarget(motion, targets, np.repeat(changed[:, None], len(JOINTS), axis=1), start)


def _softened(chain: np.ndarray, leg: np.ndarray) -> np.ndarray:
    """What is added to the vectors from hip to ankle (frames, 3) by the module's equation;
    `chain` (frames, 3 joints, 3) is the leg before."""
    before, after = (np.linalg.norm(x, axis=1) for x in (chain[:, 2] - chain[:, 0], leg))
    straight = np.linalg.norm(np.diff(chain, axis=1), axis=2).sum(axis=1)
    start = np.maximum(before, (1 - SOFT_SHARE) * straight)
    rest = np.maximum(straight - start, 1e-9)
    beyond = np.maximum(after - start, 0.0)
    length = after - beyond + rest * (1 - np.exp(-beyond / rest))
    return (length / np.maximum(after, 1e-9) - 1)[:, None] * leg


def _shifts(motion: Motion, stances: list[Stance]) -> tuple[np.ndarray, np.ndarray]:
    """How far both feet are from their places, (frames, 2, 3) in metres, fading in and out before
    and after they stand; and the weight of that, (frames, 2, 1)."""
    toes, level = _toes(motion)
    shift = np.zeros(toes.shape)
    weight = np.zeros((*toes.shape[:2], 1))
    frame = np.arange(len(motion))
    for foot, first, end in stances:
        nearest = np.clip(frame, first, end - 1)
        away = np.abs(frame - nearest) / (EASE_SECONDS * motion.rate + 1)
        u = np.clip(1 - away, 0.0, 1.0)
        share = (u * u * (3 - 2 * u))[:, None]
        place = _place(toes[first:end, foot], level)
        shift[:, foot] += share * (place - toes[nearest, foot])
        weight[:, foot] += share
    return shift / np.maximum(weight, 1.0), np.minimum(weight, 1.0)


def _toes(motion: Motion) -> tuple[np.ndarray, float]:
    """The places of both toes, (frames, 2, 3) in metres, and the height at which they stand."""
    toes = usual_toes(motion)
    lower = toes[..., 1].min(axis=1)
    step = np.linalg.norm(np.diff(toes, axis=0, append=toes[-1:]), axis=-1).min(axis=1)
    slow = step * motion.rate < SLOW_METRES_A_SECOND
    return toes, float(np.median(lower[slow] if slow.any() else lower))


def _place(toe: np.ndarray, level: float) -> np.ndarray:
    """Where a toe (frames, 3) stands: its median, at the height of the floor."""
    x, _, z = np.median(toe, axis=0)
    return np.array([x, level, z])
