"""Channels of a rig that are damaged or unknown, interpolated over these frames.

Where some of the twenty joints are missing, a rotation of the rig is unknown if every bone that it
moves ends at a missing joint. Each unknown rotation is interpolated in the joint's own coordinates
(`motion.hole_curves`); `repair.holes` chooses the curves.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from numpy_cae.cleanup.finding import Finding, findings_of_mask, joint_names
from numpy_cae.cleanup.kinds import BODY, MARKED, NOT_FINITE, ROTATION
from numpy_cae.mocap.retargeting.to_rig import bones_through
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, Motion, hole_curves
from numpy_cae.motion.hole_curves import ALL_FRAMES, CurveAt, eased_everywhere
from numpy_cae.motion.joints import joint_mask
from numpy_cae.motion.quaternions import IDENTITY


def mark_damaged_channels(
    motion: Motion, findings: Iterable[Finding]
) -> tuple[np.ndarray, np.ndarray]:
    """The rotations and the translations that are damaged: two masks (frames, J) of the rig."""
    names = joint_names(motion)
    rotations = np.zeros((len(motion), len(names)), bool)
    translations = np.zeros(rotations.shape, bool)
    missing = np.zeros((len(motion), len(JOINTS)), bool)
    for finding in findings:
        frames = finding.stretch
        if finding.joint == BODY:
            missing[frames] = True
        elif finding.row is MARKED and finding.joint in JOINTS:
            missing |= joint_mask(len(motion), [finding.joint], frames)
        else:
            joint = names.index(finding.joint)
            rotations[frames, joint] |= not finding.row.is_of_translation
            translations[frames, joint] |= finding.row.channel != ROTATION
    unknown_rotations, unknown_translations = mark_unknown_channels(motion, missing)
    translations &= np.ptp(motion.translations, axis=0).max(axis=-1) > 0
    return rotations | unknown_rotations, translations | unknown_translations


def mark_missing_joints(motion: Motion, findings: Iterable[Finding]) -> np.ndarray:
    """Which of the twenty joints are displaced by the damaged channels of findings, (frames, 20).

    A rotation displaces the joints below its joint, a translation also the joint itself. Of the
    kind "marked" only the joints named count.
    """
    missing = np.zeros((len(motion), len(JOINTS)), bool)
    names = joint_names(motion)
    rig = rig_of(motion).joints
    for finding in findings:
        frames = finding.stretch
        for column, joint in enumerate(rig):
            path = [names[above] for above in motion.skeleton.path(joint)]
            if finding.row is MARKED:
                displacing = path[:1]
            elif finding.row.is_of_translation:
                displacing = path
            else:
                displacing = path[1:]
            if finding.joint in (BODY, *displacing):
                missing[frames, column] = True
    return missing


def interpolate_channels(
    motion: Motion,
    findings: Iterable[Finding],
    curve_at: CurveAt = eased_everywhere,
    frames: np.ndarray | slice = ALL_FRAMES,
) -> Motion:
    """The motion, or some of its frames, with the damaged channels of findings interpolated."""
    return interpolate_masked(motion, *mark_damaged_channels(motion, findings), curve_at, frames)


def with_finite_values(motion: Motion) -> tuple[Motion, list[Finding]]:
    """The motion with rotations and translations that are not finite interpolated, and findings of
    these."""
    wrong = ~(np.isfinite(motion.rotations).all(-1) & np.isfinite(motion.translations).all(-1))
    if not wrong.any():
        return motion, []
    rotations = np.where(wrong[..., None], IDENTITY, motion.rotations)
    translations = np.where(wrong[..., None], motion.skeleton.offsets, motion.translations)
    finite = replace(motion, rotations=rotations, translations=translations)
    findings = findings_of_mask(wrong, joint_names(motion), NOT_FINITE)
    return interpolate_masked(finite, wrong, wrong), findings


def interpolate_joints(
    motion: Motion, missing: np.ndarray, curve_at: CurveAt = eased_everywhere
) -> Motion:
    """The motion with unknown rotations and translations interpolated over time.

    Values of the file are ignored where they are unknown. A rotation that is unknown in all frames
    is that of the rest pose. A translation is unchanged if it is unknown in all frames or constant.

    Parameters
    ----------
    motion : Motion
        A motion at any rate, on any rig in which the twenty joints can be found.
    missing : (frames, 20) array of bool
        In the frames of the file.
    curve_at : CurveAt
        Its columns are the twenty joints: a rotation has the curve of the first missing joint that
        it moves.

    Returns
    -------
    Motion

    Raises
    ------
    UnknownRigError
        If joints of the rig are missing.

    Examples
    --------
    An elbow's rotation from frames 20 to 39 of a walk, in degrees from the true one:

    >>> from data_synth import make_take
    >>> from numpy_cae.motion.joints import joint_mask
    >>> from numpy_cae.motion.quaternions import angle, inverse, product
    >>> walk = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> hole = joint_mask(60, ["left_wrist"], slice(20, 30))
    >>> elbow = walk.skeleton.index("lradius")
    >>> there, true = interpolate_joints(walk, hole).rotations[:, elbow], walk.rotations[:, elbow]
    >>> off = np.degrees(angle(product(inverse(true), there)))
    >>> off[18:32:3].round(1)
    array([0. , 0.2, 0.6, 0.3, 0. ])
    """
    return interpolate_masked(motion, *mark_unknown_channels(motion, missing), curve_at)


def interpolate_masked(
    motion: Motion,
    rotations: np.ndarray,
    translations: np.ndarray,
    curve_at: CurveAt = eased_everywhere,
    frames: np.ndarray | slice = ALL_FRAMES,
) -> Motion:
    """The motion, or some of its frames, with the channels of joints of the rig interpolated where
    the masks of `rotations` and `translations` (frames, J) say so; `curve_at` is as in
    `interpolate_joints`."""
    part = motion.at(frames)
    curve_of_joint = curves_of_rig(motion, curve_at)
    if rotations.any():
        interpolated = hole_curves.interpolate_rotations(
            motion.rotations, rotations, motion.rate, curve_of_joint, frames
        )
        part = replace(part, rotations=interpolated)
    if translations.any():
        interpolated = hole_curves.interpolate_values(
            motion.translations, translations, motion.rate, curve_of_joint, frames
        )
        part = replace(part, translations=interpolated)
    return part


def mark_unknown_channels(motion: Motion, missing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The unknown rotations and translations, two masks (frames, J) of the joints of the rig.

    A translation is unknown where the joint, or the end of the bone in which it lies, is missing.
    Where all twenty joints are missing, every channel of the rig is unknown.
    """
    joints = rig_of(motion).joints
    everything = missing.all(axis=1, keepdims=True)
    rotations = np.repeat(everything, len(motion.skeleton.names), axis=1)
    translations = rotations.copy()
    bones = bones_through(motion, joints)
    for joint, passing in bones.items():
        ends = missing[:, [joints.index(end) for *_, end in passing]]
        rotations[:, joint] |= np.asarray(ends.all(axis=1))
        for _, *below, end in passing:
            translations[:, [*below, end]] |= missing[:, [joints.index(end)]]
    translations[:, motion.skeleton.path(joints[0])] |= missing[:, [0]]
    translations &= np.ptp(motion.translations, axis=0).max(axis=-1) > 0
    return rotations, translations


def curves_of_rig(motion: Motion, curve_at: CurveAt) -> CurveAt:
    """The curves of the twenty joints as those of the joints of the rig."""
    ends = find_moved_joints(motion)
    return lambda channel, first: curve_at(ends[channel], first)


def find_moved_joints(motion: Motion) -> list[int]:
    """For each joint of the rig the first of the twenty joints that it moves, or the hips where it
    moves none."""
    joints = rig_of(motion).joints
    ends = [0] * len(motion.skeleton.names)
    for number in reversed(range(len(joints))):
        path = motion.skeleton.path(joints[number])
        if number:  # a rotation does not move its own joint; that of the hips counts as theirs
            path = path[1:]
        for joint in path:
            ends[joint] = number
    return ends
