"""Feet that stand still, on the floor.

A foot stands while its toe is low and slow. Where it changes its place meanwhile, by a pivot or a
shuffle, it stands twice. The place where it stands is the median of the toe over that time, at the
height at which toes stand in this motion. A foot that hardly slides, at that height, stays where it
is: the toes of people who were recorded roll and give way by a few centimetres a second. The
displacement from the toe to that
place fades out before and after (`FADING_SECONDS`). The root takes the mean displacement of both
feet, filtered (`PATH_HERTZ`), so that the legs change little; each leg takes the rest by its own
two bones, which keep their lengths (`motion.fit.bend_limb`). All metres are those of a body of
usual size (`View.body`).

The knee of a leg that becomes straight within a frame pops. So a leg approaches its full length L
only exponentially (soft inverse kinematics: A. Nicholas, softimageblog.com/archives/108). With d_0
the distance from hip to ankle before, and d that with which the foot is at its place, it becomes

    a + (L - a) (1 - exp(-(d - a) / (L - a)))  where d > a = max(d_0, (1 - s) L),  else d

with s = `SOFT_SHARE`. A leg that does not get longer is changed by nothing of this.

Many estimators from video give poses about a root that stands still. Let v_t be the step of the
hips from frame t to t + 1, and u_t the step with which the toe of the lower foot would stand still.
Where Σ‖v_t‖ < FOLLOWING_SHARE · Σ‖u_t‖ the root does not follow the feet. Then its path is the sum
of the medians of u_t over `CALM_SECONDS`, filtered (`PATH_HERTZ`). If the feet make no steps
(`NO_STEPS_METRES`), its path holds the mean of both toes at one place. In height, it keeps the
lower toe at one height."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.finding import Finding, confidence, is_path
from numpy_cae.cleanup.kinds import BODY, FOOT, TOES
from numpy_cae.cleanup.view import LEG_JOINTS, SHARP, View
from numpy_cae.mocap.retargeting.body import body_positions
from numpy_cae.mocap.retargeting.to_rig import retarget
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.contacts import FEET
from numpy_cae.motion.filters import butterworth, median_of
from numpy_cae.motion.fit import bend_limb
from numpy_cae.motion.masks import runs, widen_runs

HANDS = [JOINTS.index("left_wrist"), JOINTS.index("right_wrist")]
CALM_SECONDS = 0.1
"""Steps and speeds are taken over this time before and after a frame (s)."""
PATH_HERTZ = 2.5
"""The root's path is filtered with this cut-off (Hz). It and `SLOW_ON_PATH_METRES_A_SECOND` were
chosen on takes of CMU and synthetic ones whose root was held still
(docs/lab_book/evidence.md)."""
FOLLOWING_SHARE = 0.4
"""A root follows the feet if its steps are at least this share of the steps with which the feet
would stand. In 119 takes without damage the share is at least 0.82; in seven files from video it is
at most 0.23."""
HELD_METRES = 0.1
"""A root gets no path if both hands stay within this (m) in most frames, as those of a cyclist do:
then the feet need not stand on a floor."""
UPRIGHT_SHARE = 0.7
"""A root gets a path only if the hips are higher above the lower toe than this share of the length
of a leg in most frames."""
NO_STEPS_METRES = 0.3
"""The feet make no steps if 10% and 90% quantiles of the place of one toe relative to the other are
less than this (m) apart along the floor. Of people who stand still and wave, with noise of 3°, they
are at most 0.23 m apart."""
SLOW_METRES_A_SECOND = 0.5
"""A toe stands only if it is slower than this (m/s)."""
SLOW_ON_PATH_METRES_A_SECOND = 0.7
"""On a path from the feet, a toe stands only if it is slower than this (m/s)."""
LOW_METRES = 0.05
"""A toe stands only if it is at most this high (m) above the height at which toes stand, the median
height of the lower toe where it is slow."""
STANCE_SECONDS = 0.15
"""A toe stands for at least this time (s)."""
RESTING_SHARE = 0.5
"""A root gets a path only if feet on it stand for more than this share of the time: at least 0.77
in five files whose root stands still, 0.13 and 0.43 in two of noise."""
OFF_PLACE_METRES = 0.04
"""The feet of a motion are changed if one of them is further than this (m) from its place while it
stands."""
RESTING_METRES = 1e-4
"""A root that would be moved by less than this (m) stays where it is."""
FADING_SECONDS = 0.2
"""The displacement of a foot fades in and out in this time (s)."""
SOFT_SHARE = 0.015
"""The s of the module's equation."""
JUMPY_SECONDS = 0.3
"""Feet are left as they are if, held, a frame jumps within this time (s)."""
MOST_HOLDS = 4
"""Feet are held at their places at most this often: those that stand then, as long as they slide
less, or those near which no frame jumps."""
STANDING_CENTIMETRES = 1.0
"""Feet that slide by this speed (cm/s) or less stand."""


STAYING_METRES_A_SECOND = 0.03
"""A foot that slides slower than this (m/s) while it stands is left as it is. In clean files from
suits and optical systems half of the stances are slower than 2.2 cm/s, of Bandai half than 1.9, in
files from video half are faster than 21 cm/s. If none is left, the speeds of the clean takes below
are wrong by 2.5 instead of 2.4 cm/s, with 6 cm/s by 2.0; of the drifting ones by 12.1."""
STAYING_METRES = 0.04
"""A foot that is left as it is moves by at most this (m) while it stands. With 2 and 8 cm the clean
and the drifting takes below are held alike: it is for stances of many seconds."""
STEP_METRES = 0.05
"""A foot changes its place where it gets further than this (m) from where it stood. In twelve clean
takes of CMU, after feet are held, the speeds of feet that stand are wrong by 2.4 cm/s; with 3 and
8 cm by 2.3 and 3.1; in the same takes whose root drifts by 15 cm/s by 12.1, 11.9 and 12.2."""
STEP_METRES_A_SECOND = 0.15
"""While a foot changes its place it is faster than this (m/s). With 0.08 and 0.25 the speeds of the
clean takes above are wrong by 2.8 and 2.4 cm/s, of the drifting ones by 12.1."""
STEP_RATIO = 3.0
"""While a foot changes its place it is faster than this times the median while it stands: a foot
that slides or shakes all the time does not. With 2 and 5 the speeds of the clean takes above are
wrong by 2.2 and 2.7 cm/s, of the drifting ones by 12.1."""


class Stance(NamedTuple):
    """The time in which a foot stands: its index in `FEET`, its first frame and its end."""

    foot: int
    first: int
    end: int


def find_feet(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """The times in which a foot stands and slides, or is in the floor or above it.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> find_feet(View(motion))
    []
    >>> motion.translations[:, 0, 0] += np.linspace(0.0, 0.6, 60)
    >>> find_feet(View(motion))[0].kind
    'foot'
    """
    findings = list[Finding]()
    worst = 0.0
    path = path_of_root(view)
    if path.any():
        on_path = view.after(move_along(view, path))
        if _rests(on_path, view.sliding):
            evidence = "the root hardly moves while feet do: its path follows from the feet"
            findings.append(Finding(BODY, (0, len(view) - 1), FOOT.name, evidence))
            worst = np.inf
            view = on_path
    level = _standing_height(view)
    stances = _stances(view, is_on_path=bool(findings))
    if not findings:
        stances = [stance for stance in stances if not _stays(view, stance, level)]
    for stance in stances:
        toe = view.toes[stance.first : stance.end, stance.foot]
        away = np.abs(toe - _place(toe, level)).max(axis=0)
        slides = 100 * max(away[0], away[2])
        off = 100 * away[1]
        evidence = f"moves by {slides:.1f} cm, {off:.1f} cm off the floor"
        frames = (stance.first, stance.end - 1)
        findings.append(Finding(TOES[stance.foot], frames, FOOT.name, evidence))
        worst = max(worst, float(away.max()))
    if worst * 2 * sensitivity <= OFF_PLACE_METRES:
        return []
    sure = confidence(worst / OFF_PLACE_METRES)
    return [replace(finding, confidence=sure) for finding in findings]


def mend_feet(view: View, findings: list[Finding]) -> Motion:
    """The motion with the feet of the findings at their places, if they slide less so
    (`View.sliding`) and no more frames jump; else the motion itself.

    A finding about the body gives the root a path (`is_path`). A foot that stands still does so for
    longer than it seemed: it is looked for again, as long as that helps. Feet near which frames
    would jump are left as they are.
    """
    is_on_path = any(map(is_path, findings))
    best = view
    if is_on_path:
        best = view.after(move_along(view, path_of_root(view)))
    stances = []
    for finding in findings:
        if finding.joint in TOES:
            foot = TOES.index(finding.joint)
            stances.append(Stance(foot, finding.stretch.start, finding.stretch.stop))
    staying = _split_overlapping(_stances(best, is_on_path), stances)[1]
    slides = max(best.sliding, STANDING_CENTIMETRES)
    jumps = _jumping_frames(best)
    is_jumpy = np.zeros(len(view), bool)
    for _ in range(MOST_HOLDS):
        calm = [x for x in stances if not is_jumpy[x.first : x.end].any()]
        better = best.after(hold_feet(best, calm, staying))
        jumps_after = _jumping_frames(better)
        if jumps_after.sum() > jumps.sum():
            new = (jumps_after & ~jumps)[:, None]
            is_jumpy |= widen_runs(new, view.frames(JUMPY_SECONDS) + 1)[:, 0]
        elif better.sliding < slides:
            best = better
            slides = best.sliding
            jumps = jumps_after
            staying, stances = _split_overlapping(_stances(best, is_on_path), staying)
        else:
            break
    if is_on_path and (slides > view.sliding or _sharp_frames(best) > _sharp_frames(view)):
        return view.motion
    return best.motion


def path_of_root(view: View) -> np.ndarray:
    """What the path of the root lacks, (frames, 3) in metres of a body of usual size: 0 if the root
    follows the feet."""
    body = view.body
    toes = body[:, FEET]
    hips = body[:, 0]
    lower_height = toes[..., 1].min(axis=1)
    leg = np.linalg.norm(np.diff(body[0, LEG_JOINTS[0][:3]], axis=0), axis=-1).sum()
    none = np.zeros((len(view), 3))
    if len(view) < 3 or np.median(hips[:, 1] - lower_height) < UPRIGHT_SHARE * leg:
        return none
    if np.linalg.norm(_range(body[:, HANDS]), axis=-1).max() < HELD_METRES:
        return none
    root_steps = np.diff(hips, axis=0)
    lower = (toes[1:, :, 1] + toes[:-1, :, 1]).argmin(axis=1)
    # With these steps of the root the lower toe would stand still.
    standing_steps = root_steps - np.diff(toes, axis=0)[np.arange(len(root_steps)), lower]
    way = np.linalg.norm(standing_steps, axis=1).sum()
    if np.linalg.norm(root_steps, axis=1).sum() >= FOLLOWING_SHARE * way:
        return none
    between_toes = _range(toes[:, 0] - toes[:, 1])
    if np.hypot(between_toes[0], between_toes[2]) > NO_STEPS_METRES:
        missing = median_of(standing_steps - root_steps, max(view.frames(CALM_SECONDS), 1))
        path = np.concatenate([none[:1], np.cumsum(missing, axis=0)])
    else:
        path = toes[0].mean(axis=0) - toes.mean(axis=1)
    path[:, 1] = np.median(lower_height) - lower_height
    return butterworth(path, PATH_HERTZ, view.rate)


def move_along(view: View, path: np.ndarray) -> Motion:
    """The motion with its whole body moved along a path (frames, 3) of `path_of_root`."""
    return retarget(view.motion, body_positions(view.motion) + view.size * path[:, None])


def _range(x: np.ndarray) -> np.ndarray:
    """The range of values (frames, …) in most frames."""
    return np.subtract(*np.quantile(x, [0.9, 0.1], axis=0))


def _jumping_frames(view: View) -> np.ndarray:
    """The frames (frames,) in which a joint jumps."""
    return np.asarray((view.jumps > 0).any(axis=1))


def _sharp_frames(view: View) -> int:
    """How many frames have a joint that jumps sharply."""
    return int((view.jumps == SHARP).any(axis=1).sum())


def _rests(view: View, sliding_before: float) -> bool:
    """Whether feet that slid with a speed before slide less on a path, and one of them stands in
    most frames: else they do not rest on a floor, and the path is the sum of noise."""
    stands = sum(stance.end - stance.first for stance in _stances(view, is_on_path=True))
    return view.sliding < sliding_before and stands > RESTING_SHARE * len(view)


def _stances(view: View, is_on_path: bool) -> list[Stance]:
    """The times in which a foot stands."""
    if len(view) < 3:
        return []
    toes = view.toes
    frame = np.arange(len(view))
    around = max(view.frames(CALM_SECONDS), 1)
    before = (frame - around).clip(0)
    after = (frame + around).clip(max=len(view) - 1)
    way = np.linalg.norm(toes[after] - toes[before], axis=-1)
    speed = way * view.rate / (after - before)[:, None]
    slow = speed < (SLOW_ON_PATH_METRES_A_SECOND if is_on_path else SLOW_METRES_A_SECOND)
    stands = slow & (toes[..., 1] < _standing_height(view) + LOW_METRES)
    stances = []
    for foot in (0, 1):
        for first, end in runs(stands[:, foot]).tolist():
            # A root whose path follows from the feet has no steps of its own.
            parts = (
                [(0, end - first)] if is_on_path else _between_steps(toes[first:end, foot], view)
            )
            for start, stop in parts:
                if stop - start >= STANCE_SECONDS * view.rate:
                    stances.append(Stance(foot, first + start, first + stop))
    return stances


def _between_steps(toe: np.ndarray, view: View) -> list[tuple[int, int]]:
    """The times in which a slow toe (frames, 3) is at one place, their first frames and ends."""
    floor = toe[:, [0, 2]]
    steps = np.linalg.norm(np.diff(floor, axis=0, append=floor[-1:]), axis=1) * view.rate
    moves = steps > max(STEP_METRES_A_SECOND, STEP_RATIO * float(np.median(steps)))
    rests = runs(~moves)
    stands = np.ones(len(toe), bool)
    for first, end in runs(moves).tolist():
        # The rest before, or the first one.
        start, stop = rests[max(np.searchsorted(rests[:, 0], first) - 1, 0)]
        place = np.median(floor[start:stop], axis=0)
        if np.linalg.norm(floor[first : end + 1] - place, axis=1).max() > STEP_METRES:
            stands[first:end] = False
    return [(first, end) for first, end in runs(stands).tolist()]


def _stays(view: View, stance: Stance, level: float) -> bool:
    """Whether a foot hardly slides while it stands, at the height `level` at which toes stand."""
    toe = view.toes[stance.first : stance.end, stance.foot]
    floor = toe[:, [0, 2]]
    around = max(view.frames(CALM_SECONDS), 1)
    ways = np.linalg.norm(floor[around:] - floor[:-around], axis=1)
    speed = ways.mean() * view.rate / around if len(ways) else 0.0
    moved = np.linalg.norm(floor[-1] - floor[0])
    # A foot that rolls off rises; none sinks.
    off = max(float(np.median(toe[:, 1])) - level, level - float(toe[:, 1].min()))
    return bool(
        speed < STAYING_METRES_A_SECOND and moved < STAYING_METRES and off < OFF_PLACE_METRES
    )


def _split_overlapping(
    stances: list[Stance], earlier: list[Stance]
) -> tuple[list[Stance], list[Stance]]:
    """The stances of a foot that overlap with an earlier one of it, and the others."""
    overlapping = []
    others = []
    for stance in stances:
        is_overlapping = False
        for before in earlier:
            is_same_foot = stance.foot == before.foot
            if is_same_foot and stance.first < before.end and before.first < stance.end:
                is_overlapping = True
        if is_overlapping:
            overlapping.append(stance)
        else:
            others.append(stance)
    return overlapping, others


def hold_feet(view: View, stances: list[Stance], staying: list[Stance]) -> Motion:
    """The motion with each foot at its place while it stands; feet in the stances `staying` stay
    where they are."""
    shift, weight = _shifts(view, stances, staying)
    root = shift.sum(axis=1) / np.maximum(weight.sum(axis=1), 1.0)
    root = butterworth(root, PATH_HERTZ, view.rate)
    body = view.body
    targets = body + root[:, None]
    for foot, (hip, knee, ankle, toe) in enumerate(LEG_JOINTS):
        targets[:, [ankle, toe]] += (shift[:, foot] - weight[:, foot] * root)[:, None]
        chain = body[:, [hip, knee, ankle]]
        targets[:, [ankle, toe]] += _soften(chain, targets[:, ankle] - targets[:, hip])[:, None]
        targets[:, knee] = bend_limb(targets[:, hip], chain, targets[:, knee], targets[:, ankle])
    changed = shift.any(axis=(1, 2)) | (np.abs(root).max(axis=1) > RESTING_METRES)
    targets *= view.size
    # Nothing is damaged there: rotations that jump at an end of these frames are the file's.
    start = view.motion.at(changed)
    touched = np.repeat(changed[:, None], len(JOINTS), axis=1)
    return retarget(view.motion, targets, touched, start)


def _soften(chain: np.ndarray, leg: np.ndarray) -> np.ndarray:
    """What is added to the vectors from hip to ankle (frames, 3) by the module's equation;
    `chain` (frames, 3 joints, 3) is the leg before."""
    before = np.linalg.norm(chain[:, 2] - chain[:, 0], axis=1)
    after = np.linalg.norm(leg, axis=1)
    straight = np.linalg.norm(np.diff(chain, axis=1), axis=2).sum(axis=1)
    start = np.maximum(before, (1 - SOFT_SHARE) * straight)
    rest = np.maximum(straight - start, 1e-9)
    beyond = np.maximum(after - start, 0.0)
    length = after - beyond + rest * (1 - np.exp(-beyond / rest))
    return (length / np.maximum(after, 1e-9) - 1)[:, None] * leg


def _shifts(
    view: View, stances: list[Stance], staying: list[Stance]
) -> tuple[np.ndarray, np.ndarray]:
    """How far both feet are from their places, (frames, 2, 3) in metres, fading in and out before
    and after they stand; and the weight of that, (frames, 2, 1)."""
    toes = view.toes
    level = _standing_height(view)
    shift = np.zeros(toes.shape)
    weight = np.zeros((*toes.shape[:2], 1))
    frame = np.arange(len(view))
    for stance in stances + staying:
        foot, first, end = stance
        nearest = np.clip(frame, first, end - 1)
        away = np.abs(frame - nearest) / (FADING_SECONDS * view.rate + 1)
        u = np.clip(1 - away, 0.0, 1.0)
        share = (u * u * (3 - 2 * u))[:, None]
        if stance in stances:
            place = _place(toes[first:end, foot], level)
            shift[:, foot] += share * (place - toes[nearest, foot])
        weight[:, foot] += share
    return shift / np.maximum(weight, 1.0), np.minimum(weight, 1.0)


def _standing_height(view: View) -> float:
    """The height at which toes stand, metres."""
    toes = view.toes
    lower = toes[..., 1].min(axis=1)
    step = np.linalg.norm(np.diff(toes, axis=0, append=toes[-1:]), axis=-1).min(axis=1)
    slow = step * view.rate < SLOW_METRES_A_SECOND
    return float(np.median(lower[slow] if slow.any() else lower))


def _place(toe: np.ndarray, level: float) -> np.ndarray:
    """Where a toe (frames, 3) stands: its median, at the height of the floor."""
    x, _, z = np.median(toe, axis=0)
    return np.array([x, level, z])
