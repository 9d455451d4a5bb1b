"""Feet that stand still, on the floor.

A foot stands while its toe is low and slow. The place where it stands is the median of the toe over
that time, at the height at which toes stand in this motion. The displacement from the toe to that
place fades out before and after (`EASE`). The root takes the mean displacement of both feet,
filtered (`PATH`), so that the legs change little; each leg takes the rest by its own two bones,
which keep their lengths (`mocap.retarget.to_rig.bent`).

Many estimators from video give poses about a root that stands still. Let v_t be the step of the
hips from frame t to t + 1, and u_t the step with which the toe of the lower foot would stand still.
Where Σ‖v_t‖ < FOLLOWS · Σ‖u_t‖ the root does not follow the feet. Then its path is the sum of the
medians of u_t over `AROUND`, filtered (`PATH`); if the feet make no steps (`STEPS`), the path that
holds the mean of both toes at one place. In height, it keeps the lower toe at one height.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.mocap.retarget.body import body_positions
from numpy_cae.mocap.retarget.to_rig import bent, retarget
from numpy_cae.motion.contacts import FEET, foot_sliding
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.masks import runs, with_margin
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.finding import BODY, Finding
from numpy_cae.repair.jitter import butterworth, jumping_steps, median_of
from numpy_cae.repair.jumps import confidence

TOES = [JOINTS[foot] for foot in FEET]
SLOW, FASTER, LOW = 0.5, 0.7, 0.05
"""SLOW, FASTER, LOW: a toe stands if it is slower than SLOW (m/s), on a path from the feet than
FASTER, and at most LOW (m) above the height at which toes stand, the median height of the lower toe
where it is slow."""
AROUND, SECONDS = 0.1, 0.15
"""AROUND, SECONDS: the speed is the mean of AROUND (s) before and after a frame; a toe stands for
at least SECONDS (s)."""
LEAST = 0.04
"""LEAST: the feet of a motion are changed if one of them is further than this (m) from its place
while it stands."""
TINY = 1e-4
"""TINY: a root that moves less than this (m) stays where it is."""
EASE = 0.2
"""EASE: the displacement of a foot fades in and out in this time (s)."""
ROUNDS, LITTLE = 4, 1.0
"""ROUNDS, LITTLE: feet are looked for again at most ROUNDS times, as long as they slide less; feet
that slide by LITTLE (cm/s) stand."""
PATH = 2.5
"""PATH: the cut-off of the root's path (Hz). It and `FASTER` were chosen on takes of CMU and
synthetic ones whose root was held still (docs/lab_book/evidence.md)."""
FOLLOWS, UPRIGHT = 0.4, 0.7
"""FOLLOWS, UPRIGHT: of the sums of steps, if the hips are higher above the lower toe than UPRIGHT
times the length of a leg in most frames. In 119 takes without damage the root's share is at least
0.82; in seven files from video it is at most 0.23."""
STEPS = 0.3
"""STEPS: the feet make no steps if 10% and 90% quantiles of the place of one toe relative to the
other are less than this (m) apart along the floor. Of people who stand still and wave, with noise
of 3°, it is at most 0.23."""


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
    found, path = [], _path(motion)
    if path.any():
        why = "the root hardly moves while feet do: its path follows from the feet"
        found.append((np.inf, Finding(BODY, (0, len(motion) - 1), "foot", why)))
        motion = _moved(motion, path)
    toes, level = _toes(motion)
    for foot, first, end in _stances(toes, level, motion.rate, bool(path.any())):
        toe = toes[first:end, foot]
        away = np.abs(toe - _place(toe, level)).max(axis=0)
        slide, height = 100 * max(away[0], away[2]), 100 * away[1]
        why = f"moves by {slide:.1f} cm, {height:.1f} cm off the floor"
        found.append((away.max(), Finding(TOES[foot], (first, end - 1), "foot", why)))
    worst = max((away for away, _ in found), default=0.0)
    if worst * 2 * sensitivity <= LEAST:
        return []
    return [replace(finding, confidence=confidence(worst / LEAST)) for _, finding in found]


def mend_feet(motion: Motion, findings: list[Finding]) -> Motion:
    """The motion with the feet of the findings at their places; the motion itself if the feet would
    slide more (`foot_sliding`), or more frames jump.

    A finding about the body gives the root a path (`is_path`). A foot that stands still does so for
    longer than it seemed: it is looked for again, as long as that helps.
    """
    travels, unchanged = any(map(is_path, findings)), motion
    if travels:
        motion = _moved(motion, _path(motion))
    stances = [
        (TOES.index(f.joint), f.frames[0], f.frames[1] + 1) for f in findings if f.joint in TOES
    ]
    slides, jumps = max(foot_sliding(body_positions(motion), motion.rate), LITTLE), _jumps(motion)
    for _ in range(ROUNDS):
        better = _standing(motion, stances)
        new = _jumps(better) & ~jumps
        if new.any():
            near = with_margin(new[:, None], round(EASE * motion.rate) + 1)
            better = _standing(motion, [(x, a, b) for x, a, b in stances if not near[a:b].any()])
        after, left = foot_sliding(body_positions(better), motion.rate), _jumps(better)
        if after >= slides or left.sum() > jumps.sum():
            break
        motion, slides, jumps = better, after, left
        stances = _stances(*_toes(motion), motion.rate, travels)
    worse = travels and slides > foot_sliding(body_positions(unchanged), motion.rate)
    return unchanged if worse else motion


def is_path(finding: Finding) -> bool:
    """Whether a finding says that the path of the root follows from the feet."""
    return (finding.joint, finding.kind) == (BODY, "foot")


def _jumps(motion: Motion) -> np.ndarray:
    """The frames (frames,) in which a joint jumps."""
    return np.asarray(jumping_steps(motion).any(axis=1))


def _path(motion: Motion) -> np.ndarray:
    """What the path of the root lacks, (frames, 3) in metres: 0 if the root follows the feet."""
    body, path = body_positions(motion), np.zeros((len(motion), 3))
    toes, hips = body[:, FEET], body[:, 0]
    low = toes[..., 1].min(axis=1)
    leg = np.linalg.norm(np.diff(body[0, FEET[0] - 3 : FEET[0]], axis=0), axis=-1).sum()
    if len(motion) < 3 or np.median(hips[:, 1] - low) < UPRIGHT * leg:
        return path
    lower = (toes[1:, :, 1] + toes[:-1, :, 1]).argmin(axis=1)
    v = np.diff(hips, axis=0)
    u = v - np.diff(toes, axis=0)[np.arange(len(v)), lower]
    moves, asked = (np.linalg.norm(steps, axis=1).sum() for steps in (v, u))
    if moves >= FOLLOWS * asked:
        return path
    apart = np.ptp(np.quantile(toes[:, 0] - toes[:, 1], [0.1, 0.9], axis=0), axis=0)
    if np.hypot(apart[0], apart[2]) > STEPS:
        path[1:] = np.cumsum(median_of(u - v, max(round(AROUND * motion.rate), 1)), axis=0)
    else:
        path = toes[0].mean(axis=0) - toes.mean(axis=1)
    path[:, 1] = np.median(low) - low
    return butterworth(path, min(PATH, 0.48 * motion.rate), motion.rate)


def _moved(motion: Motion, path: np.ndarray) -> Motion:
    """The motion with its whole body moved along a path (frames, 3)."""
    return retarget(motion, body_positions(motion) + path[:, None])


def _stances(
    toes: np.ndarray, level: float, rate: float, travels: bool
) -> list[tuple[int, int, int]]:
    """The foot, the first frame and the end of each time in which a foot stands."""
    if len(toes) < 3:
        return []
    frame, around = np.arange(len(toes)), max(round(AROUND * rate), 1)
    before, after = (frame - around).clip(0), (frame + around).clip(max=len(toes) - 1)
    speed = np.linalg.norm(toes[after] - toes[before], axis=-1) * rate / (after - before)[:, None]
    stands = (speed < (FASTER if travels else SLOW)) & (toes[..., 1] < level + LOW)
    return [
        (foot, first, end)
        for foot in (0, 1)
        for first, end in runs(stands[:, foot]).tolist()
        if end - first >= SECONDS * rate
    ]


def _standing(motion: Motion, stances: list[tuple[int, int, int]]) -> Motion:
    """The motion with each foot at its place while it stands."""
    toes, level = _toes(motion)
    shift, weight = np.zeros(toes.shape), np.zeros((*toes.shape[:2], 1))
    frame = np.arange(len(motion))
    for foot, first, end in stances:
        nearest = np.clip(frame, first, end - 1)
        u = np.clip(1 - np.abs(frame - nearest) / (EASE * motion.rate + 1), 0.0, 1.0)
        share = (u * u * (3 - 2 * u))[:, None]
        place = _place(toes[first:end, foot], level)
        shift[:, foot] += share * (place - toes[nearest, foot])
        weight[:, foot] += share
    shift /= np.maximum(weight, 1.0)
    weight = np.minimum(weight, 1.0)
    root = shift.sum(axis=1) / np.maximum(weight.sum(axis=1), 1.0)
    root = butterworth(root, min(PATH, 0.48 * motion.rate), motion.rate)
    body = body_positions(motion)
    targets = body + root[:, None]
    for foot, toe in enumerate(FEET):
        hip, knee, ankle = toe - 3, toe - 2, toe - 1
        targets[:, [ankle, toe]] += (shift[:, foot] - weight[:, foot] * root)[:, None]
        chain = body[:, [hip, knee, ankle]]
        targets[:, knee] = bent(targets[:, hip], chain, targets[:, knee], targets[:, ankle])
    changed = weight.any(axis=(1, 2)) | (np.abs(root).max(axis=1) > TINY)
    return retarget(motion, targets, np.repeat(changed[:, None], len(JOINTS), axis=1))


def _toes(motion: Motion) -> tuple[np.ndarray, float]:
    """The places of both toes, (frames, 2, 3) in metres, and the height at which they stand."""
    toes = body_positions(motion)[:, FEET]
    lower = toes[..., 1].min(axis=1)
    step = np.linalg.norm(np.diff(toes, axis=0, append=toes[-1:]), axis=-1).min(axis=1)
    slow = step * motion.rate < SLOW
    return toes, float(np.median(lower[slow] if slow.any() else lower))


def _place(toe: np.ndarray, level: float) -> np.ndarray:
    """Where a toe (frames, 3) stands: its median, at the height of the floor."""
    x, _, z = np.median(toe, axis=0)
    return np.array([x, level, z])
