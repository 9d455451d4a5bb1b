"""Repair of a motion (holden2015, section 7, "Fixing Corrupt Motion Data").

The paper projects the whole motion (`project_motion`), which also changes what was right. `repair`
changes only what is damaged, and `fill_motion` only what the user says is missing. A repair is

    find a T-pose at the start, and set it aside
    find what the file itself shows: `find_segments`
    mend it, kind by kind, and what is found on the way: each of `STEPS`
    fill in what is missing for long, by the manifold
    put the T-pose back

Between the first and the last line, frames are counted from the end of the T-pose. The manifold
works at thirty frames a second, (F, …); masks and findings are in the frames of the file,
(frames, …).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup import jumps
from numpy_cae.cleanup.curves import slides_of
from numpy_cae.cleanup.displaced import find_displaced, mend_displaced
from numpy_cae.cleanup.feet import find_feet, mend_feet
from numpy_cae.cleanup.finding import BODY, Finding, joint_names, marked, shifted, usable
from numpy_cae.cleanup.holes import UNKNOWN_METRES, complete_holes, filled_by
from numpy_cae.cleanup.interpolated import interpolate_channels, with_finite_values
from numpy_cae.cleanup.limb_turns import find_limb_turns, mend_limb_turns
from numpy_cae.cleanup.presets import Preset
from numpy_cae.cleanup.repaired import Repaired, distances, joined, repaired_of
from numpy_cae.cleanup.spikes import find_spikes
from numpy_cae.cleanup.still import find_still, find_t_pose, is_held
from numpy_cae.manifold.filling import require_mask
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion.masks import widen_runs
from numpy_cae.motion.motion import Motion, require_finite

NEAR_SECONDS = 0.25
"""NEAR_SECONDS: jumps and sliding feet are looked at within this time of the damage (s)."""
SLIDING_SHARE = 0.1
"""SLIDING_SHARE: feet slide more if their speed grows by more than this share of it, and by more
than `SLIDING_CENTIMETRES`."""
SLIDING_CENTIMETRES = 2.0
"""SLIDING_CENTIMETRES: and by more than this (cm/s)."""
JUMPY_SHARE = 0.05
"""JUMPY_SHARE: a motion jumps all the time if joints jump sharply in more than this share of its
frames. Then its feet hardly stand, and much is won if some of the jumps near a finding are gone."""
ROUNDS = 4
"""ROUNDS: a step is taken at most this often, each time without the findings near which the motion
became worse."""


class Step(NamedTuple):
    """How damage of some kinds is mended, and found unless `find_segments` has found it (None).

    `option` is the setting of a preset with which the step is taken, "" if it is always taken. What
    leaves more than the share `jumps_left` of the jumps near a finding is undone. A step that
    `asks` is taken if there is a manifold, which its functions get too. After the step the share
    `done` of the time has passed, within a factor of two: measured on ten minutes of damaged motion
    at 60 frames a second, repaired plainly and as motion from video.
    """

    kinds: tuple[str, ...]
    find: Callable[..., list[Finding]] | None
    mend: Callable[..., Motion]
    done: float
    option: str = ""
    jumps_left: float = 1.0
    asks: bool = False


STEPS = (
    Step(("repeated", "frozen"), None, interpolate_channels, 0.25),
    Step(("turned", "displaced", "length", "root elsewhere"), None, mend_displaced, 0.3),
    Step(("spike",), None, interpolate_channels, 0.33),
    Step(("limb turned",), find_limb_turns, mend_limb_turns, 0.55, asks=True),
    Step(("jitter",), jumps.find_jitter, jumps.smooth_motion, 0.6, "smooth"),
    Step(("jumps",), jumps.find_jumps, jumps.mend_jumps, 0.7, jumps_left=0.65),
    Step(("foot",), find_feet, mend_feet, 0.89, "feet"),
)
"""STEPS: what is mended, in this order, before holes are filled in."""


def repair_motion(
    motion: Motion,
    manifold: MotionManifold | None,
    damaged: np.ndarray | None = None,
    preset: Preset | None = None,
    findings: Sequence[Finding] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Repaired:
    """Find what is damaged in a motion and mend it; the rest of the motion is unchanged.

    What the file itself shows is mended first, by `STEPS`, of which one asks the manifold too. The
    manifold then corrects what was interpolated for long. What is less certain is proposed. In a
    motion that is unlike what the manifold knows (`Repaired.known` False) it corrects only what is
    marked.

    Parameters
    ----------
    motion : Motion
        A motion at any rate, on any rig in which the twenty joints can be found.
    manifold : MotionManifold or None
        With None the steps that need no model are taken.
    damaged : (frames, 20) array of bool, optional
        In the frames of the file: only this is repaired, and nothing is looked for.
    preset : Preset, optional
        Which steps are taken; `Preset()` by default.
    findings : sequence of Finding, optional
        Only these are mended, whatever their confidence, unless their status is "proposed" or
        "left"; nothing is looked for.
    progress : function (share), optional
        Called after each step with the share of the time that has passed, roughly.

    Returns
    -------
    Repaired

    Raises
    ------
    UnknownRigError, ValueError
        If joints of the rig are missing; if a finding is of a joint or of frames that the motion
        does not have.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> from numpy_cae.cleanup import repair_motion
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30:33, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> repaired = repair_motion(motion, starter())
    >>> repaired.findings[0].joint, repaired.findings[0].frames, repaired.findings[0].kind
    ('left_elbow', (30, 32), 'spike')
    """
    preset = preset or Preset()
    given = findings if damaged is None else marked(damaged)
    if given is not None:
        given = [usable(motion, finding) for finding in given]
    finite, broken = with_finite_values(motion)
    t_pose = find_t_pose(finite) if given is None else [f for f in given if f.kind == "T-pose"]
    first = max((finding.stretch.stop for finding in t_pose), default=0)
    moving = finite.at(slice(first, None)) if first else finite
    rest = None if given is None else shifted([f for f in given if f not in t_pose], -first)
    mended, found = mend(moving, preset, rest, manifold, progress)
    found += shifted(broken, -first)
    residual = 0.0
    if manifold is not None:
        mended, residual = complete_holes(mended, manifold, found)
    found = [*t_pose, *shifted(found, first)]
    repaired = repaired_of(finite, joined(finite.at(slice(first)), mended), found, broken)
    known = residual <= UNKNOWN_METRES
    repaired = replace(repaired, original=motion, residual=residual, known=known)
    return repaired.without_first(first) if preset.cut else repaired


def mend(
    motion: Motion,
    preset: Preset | None = None,
    given: Sequence[Finding] | None = None,
    manifold: MotionManifold | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Motion, list[Finding]]:
    """The motion without the damage that the file itself shows, and what was found.

    Parameters
    ----------
    motion : Motion
    preset : Preset, optional
        Findings have a confidence of at least 1 - `preset.sensitivity`.
    given : sequence of Finding, optional
        Only these are mended, and nothing is looked for but what an option of the preset asks for.
    manifold : MotionManifold, optional
        For the steps that ask it.
    progress : function (share), optional
        As in `repair`.

    Returns
    -------
    Motion, list of Finding

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30:32, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> [finding.kind for finding in mend(motion)[1]]
    ['spike']
    """
    preset = preset or Preset()
    listed = find_segments(motion, preset.sensitivity) if given is None else given
    found: list[Finding] = []
    for step in STEPS:
        asked = step.option and getattr(preset, step.option)
        model = (manifold,) if step.asks else ()
        skipped = step.option or is_held(found, len(motion))
        if (step.asks and manifold is None) or (skipped and not asked and given is None):
            continue
        if step.find and (given is None or asked):
            damage = step.find(motion, preset.sensitivity, *model)
        else:
            damage = [finding for finding in listed if finding.kind in step.kinds]
            damage = _apart(damage, found, motion) if given is None else damage
        motion, damage = _mended(motion, damage, step, model, given is not None)
        found += damage
        if progress:
            progress(step.done)
    return motion, found + [finding for finding in given or [] if finding.kind == "marked"]


def find_segments(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """What stands still, is displaced or is a spike, in the motion as it is."""
    displaced = find_displaced(motion, sensitivity)
    spikes = _apart(find_spikes(motion, sensitivity), displaced, motion)
    return find_still(motion, sensitivity) + displaced + spikes


def _apart(findings: list[Finding], mended: list[Finding], motion: Motion) -> list[Finding]:
    """The findings that do not touch what was mended of their joint or of the whole body: a
    rotation that is frozen jumps where it ends, and all joints jump where a pose is repeated.

    Of a displacement only the ends count: what is between them is right but for it.
    """
    names = [BODY, *joint_names(motion)]
    explained = np.zeros((len(motion) + 1, len(names)), bool)
    for finding in mended:
        if finding.status == "repaired":
            explained[_frames_near(finding, motion), names.index(finding.joint)] = True
    return [
        finding
        for finding in findings
        if not explained[_frames_near(finding, motion)][:, [0, names.index(finding.joint)]].any()
    ]


def _frames_near(finding: Finding, motion: Motion) -> np.ndarray:
    """The frames of a finding and those beside them, or only those around the ends of a
    displacement."""
    frames = np.arange(finding.frames[0] - 1, finding.frames[1] + 2).clip(0, len(motion))
    is_displaced = finding.kind in ("turned", "length", "root elsewhere")
    return frames[[0, 1, -2, -1]] if is_displaced else frames


def _mended(
    motion: Motion, damage: list[Finding], step: Step, model: tuple, wanted: bool
) -> tuple[Motion, list[Finding]]:
    """The motion after a step, and its findings. If the user has not `wanted` the step, findings
    near which it makes the motion worse are left."""
    sure = [finding for finding in damage if finding.status == "repaired"]
    done = sure
    for _ in range(ROUNDS):
        mended = motion  # the last round's arrays are freed before those of this one are made
        mended = step.mend(motion, done, *model) if done else motion
        # Feet are checked where they are mended.
        worse = [] if wanted or step.find is find_feet else _worse(mended, motion, done, step)
        if not worse:
            break
        done = [finding for finding in done if finding not in worse]
    else:
        mended = motion
    if mended is motion and (step.option or worse):
        done = []
    left = [replace(finding, status="left") for finding in sure if finding not in done]
    return mended, done + left + [finding for finding in damage if finding not in sure]


def _worse(after: Motion, before: Motion, damage: list[Finding], step: Step) -> list[Finding]:
    """The findings near which a step has made the motion worse: more than the share
    `step.jumps_left` of the jumps is left, those that are sharp counted twice, or feet slide more.
    All findings if so many of the jumps near any of them are left.

    Where joints jump all the time (`JUMPY_SHARE`), each finding is judged by its jumps alone. Feet
    that slide more count if joints that jump were filtered, or the whole motion was and at least
    half of its sharp jumps are left: feet that jump hardly stand.
    """
    margin = round(NEAR_SECONDS * before.rate)
    near = np.zeros((len(before), 1), bool)
    for finding in damage:
        near[finding.stretch] = True
    frames = np.flatnonzero(widen_runs(near, margin)[:-1])
    levels = [jumps.jump_levels(motion, frames) for motion in (before, after)]
    sharp = [(level == jumps.SHARP).sum(axis=1) for level in levels]
    left = [(level > 0).sum(axis=1) for level in levels]
    is_jumpy = np.count_nonzero(sharp[0]) > JUMPY_SHARE * len(before)
    if left[1].sum() > step.jumps_left * left[0].sum() and not is_jumpy:
        return damage
    slides = np.zeros((2, len(before)))
    # A body that was still, or jumped, did not slide.
    if step.find is jumps.find_jumps or (step.option and 2 * sharp[1].sum() >= sharp[0].sum()):
        slides[:, :-1] = slides_of(before, after)
    worse = []
    for finding in damage:
        there = slice(max(finding.stretch.start - margin, 0), finding.stretch.stop + margin)
        jumped, jumps_after = (level[there].sum() for level in levels)  # a sharp jump counts twice
        slide = slides[:, there].sum(axis=1) / max(np.count_nonzero(slides[0, there]), 1)
        slid = slide[1] - slide[0] > max(SLIDING_SHARE * slide[0], SLIDING_CENTIMETRES)
        if jumps_after > step.jumps_left * jumped or (slid and not is_jumpy):
            worse.append(finding)
    return worse


def fill_motion(motion: Motion, manifold: MotionManifold, missing: np.ndarray) -> Repaired:
    """Fill in the joints of a motion that are missing; the values of the file are ignored there.

    All bone lengths are kept. A joint within a limb, such as an elbow whose wrist is given, can
    only be on a circle about the line between its neighbours and is moved to the point of it
    nearest to the filled position. Where the whole pose is missing, the root moves along a smooth
    curve, and rotations that positions do not determine (about a bone's axis, of fingers) are
    interpolated.

    Parameters
    ----------
    motion : Motion
        A motion at any rate, on any rig in which the twenty joints can be found.
    manifold : MotionManifold
    missing : (frames, 20) array of bool
        In the frames of the file; `keyframe_mask` makes that of keyframes.

    Returns
    -------
    Repaired

    Raises
    ------
    UnknownRigError, ValueError
        If joints of the rig are missing; if the mask has another shape; if values of the motion are
        not finite, which `repair` mends.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import keyframe_mask, starter
    >>> from numpy_cae.cleanup import fill_motion
    >>> motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> fill_motion(motion, starter(), keyframe_mask(30, 10))
    all joints: frames 1 to 9, 11 to 19: moved 3.8 cm, at most 26.1
    """
    require_finite(motion)
    missing = require_mask(missing, len(motion))
    filled = filled_by(manifold, Body(motion, manifold.lengths), marked(missing))
    return Repaired(filled, missing, distances(motion, filled), original=motion)
