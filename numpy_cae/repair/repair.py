"""Repair of a motion (holden2015, section 7, "Fixing Corrupt Motion Data").

The paper projects the whole motion (`project_motion`), which also changes what was right. `repair`
changes only what is damaged, and `fill_motion` only what the user says is missing. A motion is
taken to thirty frames a second once, (F, …), and the repaired joints are taken back to the frames
of the file once, (frames, …).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.manifold.fill import checked_mask, corrected
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retarget.body import Body
from numpy_cae.motion.hole_curves import CurveAt, eased_everywhere
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.feet import is_path
from numpy_cae.repair.finding import BODY, Finding
from numpy_cae.repair.holes import Holes
from numpy_cae.repair.interpolated import POSITIONS, interpolate, missing_joints
from numpy_cae.repair.jumps import joint_names
from numpy_cae.repair.presets import Preset
from numpy_cae.repair.repaired import Repaired, distances, with_centimetres
from numpy_cae.repair.rotation_curves import channels_on_curves, on_curves
from numpy_cae.repair.steps import LEFT, mend
from numpy_cae.repair.t_pose import find_t_pose
from numpy_cae.repair.trials import chosen
from numpy_cae.repair.unlikely import find_unlikely

UNKNOWN = 0.12
"""UNKNOWN: a motion is unlike what the manifold knows if its residual exceeds this (m), which is
more than that of any take of a source left out of training (docs/lab_book/detection.md)."""
LONG = 0.1
"""LONG: the manifold corrects what was interpolated over more than this time (s)."""
MOVED = 1e-6
"""MOVED: a joint is touched if it moves by more than this (m)."""
FILLED = ("repeated", "frozen", "displaced", "not finite")
"""Kinds of findings that the manifold fills in where they are long, besides `POSITIONS`."""


def repair(
    motion: Motion,
    manifold: MotionManifold | None,
    damaged: np.ndarray | None = None,
    preset: Preset | None = None,
    findings: Sequence[Finding] | None = None,
) -> Repaired:
    """Find what is damaged in a motion and mend it; the rest of the motion is unchanged.

    What the file itself shows is mended first, without the manifold (`evidence`). The manifold then
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
        Only these are mended, whatever their confidence, and nothing is looked for.

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
    rest = findings if damaged is None else marked(damaged)
    _require_usable(motion, rest or [])
    whole, broken = _finite(motion)
    pose = find_t_pose(whole) if rest is None else [f for f in rest if f.kind == "T-pose"]
    first = max((finding.frames[1] + 1 for finding in pose), default=0)
    moving = whole.at(slice(first, None)) if first else whole
    if rest is not None:
        rest = _shifted([finding for finding in rest if finding not in pose], -first)
    mended, found = mend(moving, preset, rest)
    found += _shifted(broken, -first) + [f for f in rest or [] if f.kind in POSITIONS]
    distance, unlikely = 0.0, list[Finding]()
    if manifold is not None:
        look = preset if rest is None else None
        # The memory that finding needs, 0.2 GB for an hour, is free before the motion is filled.
        filling, features, distance, unlikely = _filling(mended, manifold, found, look)
        mended = filling.filled(features, moving)
    kept = whole.at(slice(0 if preset.cut else first))
    if len(kept):
        mended = _joined(kept, mended)
    before = whole.at(slice(first - len(kept), None))
    moved = posed = distances(before, mended)
    if any(is_path(finding) for finding in found):
        posed = distances(before, mended, from_hips=True)
    touched = (moved > MOVED) | missing_joints(mended, _shifted(broken, len(kept) - first))
    found += [finding for finding in unlikely if preset.is_sure(finding)]
    left = [finding for finding in found if finding.evidence.endswith(LEFT)]
    found = [finding for finding in found if finding not in left]
    left += [finding for finding in unlikely if not preset.is_sure(finding)]
    known, left = distance <= UNKNOWN, _shifted(left, first)
    found = pose + _shifted(with_centimetres(found, moved, posed, len(kept)), first)
    return Repaired(mended, touched, moved, distance, known, tuple(found), tuple(left))


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
        If joints of the rig are missing; if the mask has another shape.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import keyframe_mask, starter
    >>> from numpy_cae.repair import fill_motion
    >>> motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> fill_motion(motion, starter(), keyframe_mask(30, 10))
    all joints: frames 1 to 9, 11 to 19: moved 3.7 cm, at most 24.0
    """
    missing, body = checked_mask(missing, len(motion)), Body(motion, manifold.lengths)
    curve_at, strength = chosen(manifold, body, missing)
    start = on_curves(motion, missing, curve_at).at(np.asarray(missing.any(axis=1)))
    holes = Holes(body, missing, start)
    filled = holes.filled(corrected(manifold, holes.features, holes.mask, strength))
    return Repaired(filled, missing, distances(motion, filled))


def marked(mask: np.ndarray, names: Sequence[str] = JOINTS, kind: str = "marked") -> list[Finding]:
    """The runs of a mask (frames, joints) as findings of a kind."""
    return [
        Finding(name, (int(first), int(end) - 1), kind)
        for name, column in zip(names, mask.T, strict=True)
        for first, end in runs(column)
    ]


def _filling(
    motion: Motion, manifold: MotionManifold, found: list[Finding], preset: Preset | None
) -> tuple[Holes, np.ndarray, float, list[Finding]]:
    """The holes of findings, the features with which the manifold fills them, the typical distance
    of the motion from it, and, with a preset, what is unlikely; what is sure enough is a hole too.

    A motion that is unlike what the manifold knows gets only what the user marked.
    """
    manifold = manifold.remembering()
    body, least = Body(motion, manifold.lengths), LONG * motion.rate

    def is_filled(finding: Finding) -> bool:
        long = finding.frames[1] - finding.frames[0] >= least
        return finding.kind in POSITIONS or (finding.kind in FILLED and long)

    def holes(findings: list[Finding], curve_at: CurveAt = eased_everywhere) -> Holes:
        missing = missing_joints(motion, findings)
        there = np.asarray(missing.any(axis=1))
        return Holes(body, missing, interpolate(motion, findings, curve_at, there))

    found = list(filter(is_filled, found))
    filling = holes(found)
    distance, unlikely = filling.typical_residual(manifold), []
    if distance > UNKNOWN:
        found = [finding for finding in found if finding.kind in POSITIONS]
    elif preset is not None:
        unlikely = find_unlikely(manifold, body, filling.in_file)
        found += [finding for finding in unlikely if preset.is_sure(finding)]
    curve_at, strength = chosen(manifold, body, missing_joints(motion, found))
    filling = holes(found, curve_at)
    features = corrected(manifold, filling.features, filling.mask, strength)
    return filling, features, distance, unlikely


def _require_usable(motion: Motion, findings: Sequence[Finding]) -> None:
    """ValueError if a finding is of no joint or frames of the motion."""
    names = {BODY, *JOINTS, *motion.skeleton.names}
    for finding in findings:
        if finding.joint not in names:
            raise ValueError(f"{finding}: the rig has no joint {finding.joint!r}")
        if finding.frames[1] >= len(motion):
            raise ValueError(f"{finding}: the motion has frames 0 to {len(motion) - 1}")


def _shifted(findings: Sequence[Finding], later: int) -> list[Finding]:
    """The findings some frames later; what lies before frame 0 is left out."""
    ends = [(finding, *np.add(finding.frames, later).tolist()) for finding in findings]
    return [replace(finding, frames=(max(a, 0), b)) for finding, a, b in ends if b >= 0]


def _joined(start: Motion, rest: Motion) -> Motion:
    """The frames of one motion and then those of another."""
    return replace(
        rest,
        rotations=np.concatenate([start.rotations, rest.rotations]),
        translations=np.concatenate([start.translations, rest.translations]),
    )


def _finite(motion: Motion) -> tuple[Motion, list[Finding]]:
    """The motion with rotations and translations that are not finite interpolated, and these."""
    wrong = ~(np.isfinite(motion.rotations).all(-1) & np.isfinite(motion.translations).all(-1))
    if not wrong.any():
        return motion, []
    rotations = np.where(wrong[..., None], [0.0, 0.0, 0.0, 1.0], motion.rotations)
    translations = np.where(wrong[..., None], motion.skeleton.offsets, motion.translations)
    known = replace(motion, rotations=rotations, translations=translations)
    found = marked(wrong, joint_names(motion), "not finite")
    return channels_on_curves(known, wrong, wrong), found
