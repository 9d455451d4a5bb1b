"""Repair of a motion (holden2015, section 7, "Fixing Corrupt Motion Data").

The paper projects the whole motion (`project_motion`), which also changes what was right. `repair`
changes only what is damaged, and `fill_motion` only what the user says is missing. A repair is

    find a T-pose at the start, and set it aside
    find and mend what the file itself shows: each of `STEPS`
    fill in what is missing for long, by the manifold
    put the T-pose back

Between the first and the last line, frames are counted from the end of the T-pose. For the manifold
a motion is taken to thirty frames a second once, (F, …), and the repaired joints are taken back to
the frames of the file once, (frames, …).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numpy_cae.manifold.fill import checked_mask, corrected
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retarget.body import Body, body_positions
from numpy_cae.motion.contacts import foot_sliding
from numpy_cae.motion.hole_curves import CurveAt, eased_everywhere
from numpy_cae.motion.joints import LIMBS
from numpy_cae.motion.masks import with_margin
from numpy_cae.motion.motion import Motion, require_finite
from numpy_cae.repair.displaced import find_displaced, mend_displaced
from numpy_cae.repair.feet import find_feet, mend_feet
from numpy_cae.repair.finding import BODY, Finding, is_path, marked, shifted, usable
from numpy_cae.repair.holes import Holes
from numpy_cae.repair.interpolated import (
    POSITION_KINDS,
    interpolate_channels,
    missing_joints,
    with_finite_values,
)
from numpy_cae.repair.jitter import find_jitter, smooth_motion
from numpy_cae.repair.jumps import find_jumps, jumping_steps, mend_jumps
from numpy_cae.repair.presets import Preset
from numpy_cae.repair.repaired import Repaired, distances, with_centimetres
from numpy_cae.repair.rotation_curves import on_curves
from numpy_cae.repair.spikes import find_spikes
from numpy_cae.repair.still import find_still
from numpy_cae.repair.t_pose import find_t_pose
from numpy_cae.repair.trials import chosen
from numpy_cae.repair.unlikely import find_unlikely

UNKNOWN_METRES = 0.12
"""UNKNOWN_METRES: a motion is unlike what the manifold knows if its residual exceeds this (m),
which is more than that of any take of a source left out of training
(docs/lab_book/detection.md)."""
LONG_SECONDS = 0.1
"""LONG_SECONDS: the manifold corrects what was interpolated over at least this time (s)."""
MOVED_METRES = 1e-6
"""MOVED_METRES: a joint is touched if it moves by more than this (m)."""
FILLED_KINDS = ("repeated", "frozen", "displaced", "not finite")
"""FILLED_KINDS: the manifold fills in findings of these kinds where they are long, and those of
`POSITION_KINDS`."""


LEG_JOINTS = {BODY, "hips", "left_hip", "right_hip", *LIMBS["left_leg"], *LIMBS["right_leg"]}
NEAR_SECONDS = 0.25
"""NEAR_SECONDS: jumps are counted within this time of the damage (s)."""
SLIDING_SHARE, SLIDING_CENTIMETRES = 0.2, 5.0
"""SLIDING_SHARE, SLIDING_CENTIMETRES: feet slide more if their speed grows by more than this share
of it, and by more than this (cm/s)."""


class Step(NamedTuple):
    """How damage of some kinds is found and mended.

    `option` is the setting of a preset with which the step is taken, "" if it is always taken. What
    leaves more than the share `jumps_left` of the jumps near the damage is undone.
    """

    kinds: tuple[str, ...]
    find: Callable[[Motion, float], list[Finding]]
    mend: Callable[[Motion, list[Finding]], Motion]
    option: str = ""
    jumps_left: float = 1.1


STEPS = (
    Step(("repeated", "frozen"), find_still, interpolate_channels),
    Step(("turned", "displaced", "length", "root elsewhere"), find_displaced, mend_displaced),
    Step(("spike",), find_spikes, interpolate_channels),
    Step(("jitter",), find_jitter, smooth_motion, "smooth"),
    Step(("jumps",), find_jumps, mend_jumps, jumps_left=0.6),
    Step(("foot",), find_feet, mend_feet, "feet"),
)
"""STEPS: what is mended without a model, in this order."""


def repair(
    motion: Motion,
    manifold: MotionManifold | None,
    damaged: np.ndarray | None = None,
    preset: Preset | None = None,
    findings: Sequence[Finding] | None = None,
) -> Repaired:
    """Find what is damaged in a motion and mend it; the rest of the motion is unchanged.

    What the file itself shows is mended first, without the manifold, by `STEPS`. The manifold then
    corrects what was interpolated for long. What only the manifold says is proposed. A motion that
    is unlike what the manifold knows (`Repaired.known` False) gets the first part, and from the
    manifold only what is marked.

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
    >>> from numpy_cae.repair import repair
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30:33, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> repaired = repair(motion, starter())
    >>> repaired.findings[0].joint, repaired.findings[0].frames, repaired.findings[0].kind
    ('left_elbow', (30, 32), 'spike')
    """
    preset = preset or Preset()
    given = findings if damaged is None else marked(damaged)
    given = None if given is None else [usable(motion, finding) for finding in given]
    finite, broken = with_finite_values(motion)
    t_pose = find_t_pose(finite) if given is None else [f for f in given if f.kind == "T-pose"]
    first = max((finding.stretch.stop for finding in t_pose), default=0)
    moving = finite.at(slice(first, None)) if first else finite
    rest = None if given is None else [finding for finding in given if finding not in t_pose]
    rest = None if rest is None else shifted(rest, -first)
    repaired = _repaired(moving, manifold, preset, rest, shifted(broken, -first))
    kept = finite.at(slice(0 if preset.cut else first))
    return replace(_with_t_pose(repaired, t_pose, kept, broken), original=motion)


def _repaired(
    motion: Motion,
    manifold: MotionManifold | None,
    preset: Preset,
    given: list[Finding] | None,
    broken: list[Finding],
) -> Repaired:
    """A motion without its T-pose, repaired. `broken` values are interpolated already."""
    not_mended = [finding for finding in given or [] if finding.status != "repaired"]
    if given is not None:
        given = [finding for finding in given if finding.status == "repaired"]
    mended, found = mend(motion, preset, given)
    found += broken + [finding for finding in given or [] if finding.kind in POSITION_KINDS]
    residual, unlikely = 0.0, list[Finding]()
    if manifold is not None:
        # The memory that finding needs, 0.2 GB for an hour, is free before the motion is filled.
        filling = _filling(mended, manifold, found, preset if given is None else None)
        residual, unlikely = filling.residual, filling.unlikely
        mended = filling.holes.filled(filling.features)
    moved = posed = distances(motion, mended)
    if any(is_path(finding) for finding in found):
        posed = distances(motion, mended, from_hips=True)
    touched = (moved > MOVED_METRES) | missing_joints(mended, broken)
    done = [finding for finding in found + unlikely if finding.status == "repaired"]
    left = [finding for finding in found + unlikely if finding.status != "repaired"]
    return Repaired(
        mended,
        touched,
        moved,
        residual,
        residual <= UNKNOWN_METRES,
        tuple(with_centimetres(done, moved, posed)),
        tuple(left + not_mended),
    )


def _with_t_pose(
    repaired: Repaired, t_pose: list[Finding], kept: Motion, broken: list[Finding]
) -> Repaired:
    """The repaired motion after the frames of the T-pose that are kept, in the frames of the file.
    The motion of the T-pose has `broken` values, which are interpolated already."""
    first = max((finding.stretch.stop for finding in t_pose), default=0)
    findings = (*t_pose, *shifted(repaired.findings, first))
    repaired = replace(
        repaired, findings=findings, proposed=tuple(shifted(repaired.proposed, first))
    )
    if not len(kept):
        return repaired
    motion = replace(
        repaired.motion,
        rotations=np.concatenate([kept.rotations, repaired.motion.rotations]),
        translations=np.concatenate([kept.translations, repaired.motion.translations]),
    )
    before = [finding for finding in broken if finding.frames[0] < len(kept)]
    touched = missing_joints(motion, before)[: len(kept)]
    return replace(
        repaired,
        motion=motion,
        touched=np.concatenate([touched, repaired.touched]),
        moved=np.concatenate([np.zeros(touched.shape), repaired.moved]),
    )


def mend(
    motion: Motion, preset: Preset | None = None, given: Sequence[Finding] | None = None
) -> tuple[Motion, list[Finding]]:
    """The motion without the damage that the file itself shows, and what was found.

    Parameters
    ----------
    motion : Motion
    preset : Preset, optional
        Findings have a confidence of at least 1 - `preset.sensitivity`.
    given : sequence of Finding, optional
        Only these are mended, and nothing is looked for but what an option of the preset asks for.

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
    preset, found = preset or Preset(), list[Finding]()
    for step in STEPS:
        if step.option and getattr(preset, step.option):
            damage = step.find(motion, preset.sensitivity)
        elif given is not None:
            damage = [finding for finding in given if finding.kind in step.kinds]
        else:
            damage = [] if step.option else step.find(motion, preset.sensitivity)
        if given is None and not step.option:
            motion, damage = _mended_if_better(motion, damage, step)
        elif damage:
            mended = step.mend(motion, damage)
            if step.option and mended is motion:
                damage = [replace(finding, status="left") for finding in damage]
            motion = mended
        found += damage
    return motion, found


def _mended_if_better(
    motion: Motion, damage: list[Finding], step: Step
) -> tuple[Motion, list[Finding]]:
    """The motion after a step, and its findings. Where feet slide more or joints jump more, the
    findings in the legs are left; where that does not help, all are."""
    legs = [finding for finding in damage if finding.joint in LEG_JOINTS]
    others = [finding for finding in damage if finding.joint not in LEG_JOINTS]
    for some in (damage, others, legs) if legs and others else (damage,):
        mended = step.mend(motion, some) if some else motion
        if some and is_better(mended, motion, some, step):
            left = [replace(finding, status="left") for finding in damage if finding not in some]
            return mended, some + left
    return motion, [replace(finding, status="left") for finding in damage]


def is_better(after: Motion, before: Motion, damage: list[Finding], step: Step) -> bool:
    """Whether a step has left no more jumps near some damage than `step.jumps_left` of those
    before, and, if it filters, whether standing feet slide no more."""
    near = np.zeros((len(before), 1), bool)
    for finding in damage:
        near[finding.stretch] = True
    frames = np.flatnonzero(with_margin(near, round(NEAR_SECONDS * before.rate))[:-1])
    jumps = [int(jumping_steps(motion, frames).sum()) for motion in (before, after)]
    if jumps[1] > step.jumps_left * jumps[0]:
        return False
    if step.find is not find_jumps:  # a body that was still did not slide
        return True
    slides = [foot_sliding(body_positions(motion), motion.rate) for motion in (before, after)]
    return slides[1] - slides[0] <= max(SLIDING_SHARE * slides[0], SLIDING_CENTIMETRES)


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
    >>> from numpy_cae.repair import fill_motion
    >>> motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> fill_motion(motion, starter(), keyframe_mask(30, 10))
    all joints: frames 1 to 9, 11 to 19: moved 3.7 cm, at most 24.0
    """
    require_finite(motion)
    missing, body = checked_mask(missing, len(motion)), Body(motion, manifold.lengths)
    curve_at, strength = chosen(manifold, body, missing)
    start = on_curves(motion, missing, curve_at).at(np.asarray(missing.any(axis=1)))
    holes = Holes(body, missing, start)
    filled = holes.filled(corrected(manifold, holes.features, holes.mask, strength))
    return Repaired(filled, missing, distances(motion, filled), original=motion)


class _Filling(NamedTuple):
    """The holes of findings, the features (F, 63) with which the manifold fills them, the typical
    distance (m) of the motion from the manifold, and what is unlikely."""

    holes: Holes
    features: np.ndarray
    residual: float
    unlikely: list[Finding]


def _filling(
    motion: Motion, manifold: MotionManifold, found: list[Finding], preset: Preset | None
) -> _Filling:
    """How the manifold fills in findings; with a preset it is also asked what is unlikely, and what
    is sure enough is filled in too.

    A motion that is unlike what the manifold knows gets only what the user marked.
    """
    manifold = manifold.remembering()
    body, least_frames = Body(motion, manifold.lengths), LONG_SECONDS * motion.rate
    found = [finding for finding in found if _is_filled(finding, least_frames)]
    holes = _holes_of(body, found)
    residual, unlikely = holes.typical_residual(manifold), list[Finding]()
    if residual > UNKNOWN_METRES:
        found = [finding for finding in found if finding.kind in POSITION_KINDS]
    elif preset is not None:
        for finding in find_unlikely(manifold, body, holes.in_file):
            sure = preset.is_sure(finding)
            unlikely.append(replace(finding, status="repaired") if sure else finding)
        found += [finding for finding in unlikely if finding.status == "repaired"]
    curve_at, strength = chosen(manifold, body, missing_joints(motion, found))
    holes = _holes_of(body, found, curve_at)
    features = corrected(manifold, holes.features, holes.mask, strength)
    return _Filling(holes, features, residual, unlikely)


def _is_filled(finding: Finding, least_frames: float) -> bool:
    is_long = finding.frames[1] - finding.frames[0] >= least_frames
    return finding.kind in POSITION_KINDS or (finding.kind in FILLED_KINDS and is_long)


def _holes_of(body: Body, findings: list[Finding], curve_at: CurveAt = eased_everywhere) -> Holes:
    missing = missing_joints(body.motion, findings)
    there = np.asarray(missing.any(axis=1))
    return Holes(body, missing, interpolate_channels(body.motion, findings, curve_at, there))
