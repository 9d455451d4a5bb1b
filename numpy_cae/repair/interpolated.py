"""Channels of a motion that are damaged, interpolated over the frames of findings."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion.hole_curves import (
    EVERY,
    CurveAt,
    eased_everywhere,
    over_holes,
    rotations_over_holes,
)
from numpy_cae.motion.joints import JOINTS, joint_mask
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import IDENTITY
from numpy_cae.repair.curves import Curve
from numpy_cae.repair.finding import BODY, Finding, joint_names, marked
from numpy_cae.repair.rotation_curves import channels_on_curves, unknown_channels
from numpy_cae.repair.segments import Segment

ROTATION_KINDS, TRANSLATION_KINDS = ("spike", "displaced", "frozen"), ("length", "root elsewhere")
"""ROTATION_KINDS, TRANSLATION_KINDS: of findings of these kinds the joint's rotation is damaged, or
its translation."""
POSITION_KINDS = ("marked", "unlikely")
"""POSITION_KINDS: findings of these kinds say that one of the twenty joints is at a wrong
position."""


def interpolated_curve(curve: Curve, segments: Sequence[Segment]) -> Curve:
    """A curve interpolated over segments."""
    missing = np.zeros((len(curve.values), 1), bool)
    for segment in segments:
        missing[segment.first : segment.end] = True
    over = rotations_over_holes if curve.is_rotation else over_holes
    return replace(curve, values=over(curve.values[:, None], missing, curve.rate)[:, 0])


def damaged_channels(motion: Motion, findings: Iterable[Finding]) -> tuple[np.ndarray, np.ndarray]:
    """The rotations and the translations that are damaged: two masks (frames, J) of the rig."""
    names = joint_names(motion)
    turned, moved = (np.zeros((len(motion), len(names)), bool) for _ in range(2))
    missing = np.zeros((len(motion), len(JOINTS)), bool)
    for finding in findings:
        frames = finding.stretch
        if finding.joint == BODY:
            missing[frames] = True
        elif finding.kind in POSITION_KINDS and finding.joint in JOINTS:
            missing |= joint_mask(len(motion), [finding.joint], frames)
        else:
            joint = names.index(finding.joint)
            turned[frames, joint] |= finding.kind not in TRANSLATION_KINDS
            moved[frames, joint] |= finding.kind not in ROTATION_KINDS
    if missing.any():
        of_rig = unknown_channels(motion, missing)
        turned, moved = turned | of_rig[0], moved | of_rig[1]
    return turned, moved & (np.ptp(motion.translations, axis=0).max(axis=-1) > 0)


def missing_joints(motion: Motion, findings: Iterable[Finding]) -> np.ndarray:
    """Which of the twenty joints are displaced by the damaged channels of findings, (frames, 20).

    A rotation displaces the joints below its joint, a translation also the joint itself. Of the
    kinds `POSITION_KINDS` only the joints named count.
    """
    missing = np.zeros((len(motion), len(JOINTS)), bool)
    names, rig = joint_names(motion), rig_of(motion).joints
    for finding in findings:
        frames = finding.stretch
        for column, joint in enumerate(rig):
            path = [names[above] for above in motion.skeleton.path(joint)]
            itself = finding.kind in (*POSITION_KINDS, *TRANSLATION_KINDS) or finding.joint == BODY
            above = path[0:1] if finding.kind in POSITION_KINDS else path[not itself :]
            if finding.joint in (BODY, *above):
                missing[frames, column] = True
    return missing


def interpolate_channels(
    motion: Motion,
    findings: Iterable[Finding],
    curve_at: CurveAt = eased_everywhere,
    frames: np.ndarray | slice = EVERY,
) -> Motion:
    """The motion, or some of its frames, with the damaged channels of findings interpolated
    (`repair.rotation_curves`)."""
    return channels_on_curves(motion, *damaged_channels(motion, findings), curve_at, frames)


def with_finite_values(motion: Motion) -> tuple[Motion, list[Finding]]:
    """The motion with rotations and translations that are not finite interpolated, and these."""
    wrong = ~(np.isfinite(motion.rotations).all(-1) & np.isfinite(motion.translations).all(-1))
    if not wrong.any():
        return motion, []
    rotations = np.where(wrong[..., None], IDENTITY, motion.rotations)
    translations = np.where(wrong[..., None], motion.skeleton.offsets, motion.translations)
    known = replace(motion, rotations=rotations, translations=translations)
    found = marked(wrong, joint_names(motion), "not finite")
    return channels_on_curves(known, wrong, wrong), found
