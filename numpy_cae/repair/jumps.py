"""Joints that jump from frame to frame within noise, and a strong filter there.

Where a joint jumps, the curves on the way to it that are not smooth are filtered strongly
(`filters.strongly_filtered`), and the result is blended into the rest on both sides.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion.joints import JOINTS, joint_mask
from numpy_cae.motion.masks import runs, with_margin
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import slerp
from numpy_cae.repair.chunks import changed_around, chunks
from numpy_cae.repair.curves import curves_of, off_cubic
from numpy_cae.repair.filters import LEAST_FRAMES, filter_motion, median_of, strongly_filtered
from numpy_cae.repair.finding import BODY, Finding

OFF_MEDIAN_METRES = 0.08
"""OFF_MEDIAN_METRES: a step jumps if it differs from the median of seven steps by more than this
(m)."""
OFF_CUBIC_METRES = OFF_MEDIAN_METRES / 2
"""OFF_CUBIC_METRES: a joint that jumps within a motion that is not filtered is further than this
from a cubic (m), as after a single step of `OFF_MEDIAN_METRES`. In 88 takes of Bandai without
damage none is (docs/lab_book/evidence.md)."""
ROUNDS = 3
"""ROUNDS: the strong filter acts at most this often."""
BLENDED_SECONDS, AROUND_SECONDS = 0.25, 1.0
"""BLENDED_SECONDS, AROUND_SECONDS: the strong filter acts from so long before a jump to so long
after it (s), and is computed from AROUND_SECONDS before it to AROUND_SECONDS after it."""
ROUGH_SHARE = 0.2
"""ROUGH_SHARE: a rotation on the way to a joint that jumps is filtered if its roughness is at least
this share of the largest on the way."""


def find_jumps(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """The times in which one of the twenty joints jumps from frame to frame, of kind "jumps".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[20:40:2, motion.skeleton.index("lwrist")] += 0.2
    >>> find_jumps(motion)
    [left_wrist: frames 19 to 38: jumps ...
    """
    curves = list(curves_of(motion)) if len(motion) >= LEAST_FRAMES else []
    rough = sum((curve.roughness() for curve in curves), np.zeros(len(motion)))
    near = with_margin(rough[:, None] > OFF_CUBIC_METRES, 1)[:, 0]
    least = OFF_CUBIC_METRES / (2 * sensitivity)
    jumps = jumping_steps(motion, np.flatnonzero(near[:-1]), least)
    found = []
    for column in np.flatnonzero(jumps.any(axis=0)).tolist():
        joined = with_margin(jumps[:, [column]], round(BLENDED_SECONDS * motion.rate / 2))[:, 0]
        for first, end in runs(joined).tolist():
            at = first + np.flatnonzero(jumps[first:end, column])
            by = f"by more than {100 * OFF_MEDIAN_METRES:.0f} cm"
            why = f"{len(at)} steps differ from those around them {by}"
            found.append(Finding(JOINTS[column], (int(at[0]), int(at[-1])), "jumps", why))
    return found


def mend_jumps(motion: Motion, findings: Sequence[Finding]) -> Motion:
    """The motion with the joints of the findings filtered there."""
    jumps = np.zeros((len(motion), len(JOINTS)), bool)
    for finding in findings:
        joints = JOINTS if finding.joint == BODY else [finding.joint]
        jumps |= joint_mask(len(motion), joints, finding.stretch)
    return without_jumps(motion, jumps)


def without_jumps(motion: Motion, jumps: np.ndarray, source: Motion | None = None) -> Motion:
    """The motion with the joints that jump (frames, 20) filtered strongly around, and again where
    they still jump; first with the values of `source`, in which a jump is not smeared, if given."""
    source = motion if source is None else source
    margin = round(AROUND_SECONDS * motion.rate)
    for _ in range(ROUNDS if len(motion) >= LEAST_FRAMES else 0):
        some = np.asarray(jumps.any(axis=1))

        def filtered(frames: slice, now=motion, before=source, where=jumps) -> Motion:
            return _filtered_around(now.at(frames), where[frames], before.at(frames))

        motion = source = changed_around(motion, some, margin, LEAST_FRAMES, filtered)
        near = with_margin(some[:, None], margin)[:, 0]
        beside = with_margin(jumps, round(BLENDED_SECONDS * motion.rate))
        jumps = jumping_steps(motion, np.flatnonzero(near[:-1])) & beside
        if not jumps.any():
            break
    return motion


def jumping_steps(
    motion: Motion, frames: np.ndarray | None = None, least: float = 0.0
) -> np.ndarray:
    """The steps to the next frame that jump: those that differ by more than `OFF_MEDIAN_METRES`
    from the median of seven steps, (frames, 20) of bool.

    If `frames` are given, only these are looked at. If `least` (m) is, a joint must also be at
    least this far from the cubic through the two frames before it and the two after it.
    """
    jumps, joints = np.zeros((len(motion), len(JOINTS)), bool), rig_of(motion).joints
    for part, around in chunks(np.arange(len(motion) - 1) if frames is None else frames, 4):
        positions = motion.at(around).positions(joints)
        steps = np.diff(positions, axis=0)
        steps -= median_of(steps, 3)
        off = np.linalg.norm(off_cubic(positions), axis=-1)
        row = part - around.start
        jumps[part] = (np.linalg.norm(steps, axis=-1) > OFF_MEDIAN_METRES)[row]
        jumps[part] &= np.maximum(off[:-1], off[1:])[row] >= least
    return jumps


def _filtered_around(motion: Motion, jumps: np.ndarray, source: Motion) -> Motion:
    """The motion with the rotations and translations of the joints on the way from the root to
    those that jump (frames, 20) those of `source` filtered around, as far as they are not smooth
    there."""
    strong = filter_motion(source, lambda curve: strongly_filtered(curve, motion.rate))
    near = with_margin(_rough_on_the_way(source, jumps), round(BLENDED_SECONDS * motion.rate))
    width = max(2 * round(BLENDED_SECONDS * motion.rate / 2) + 1, 3)
    window = np.hanning(width + 2)[1:-1] / np.hanning(width + 2).sum()
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    for joint in np.flatnonzero(near.any(axis=0)).tolist():
        padded = np.pad(near[:, joint].astype(float), width // 2, "edge")
        share = np.convolve(padded, window, "valid")
        rotations[:, joint] = slerp(rotations[:, joint], strong.rotations[:, joint], share)
        change = strong.translations[:, joint] - translations[:, joint]
        translations[:, joint] += share[:, None] * change
    return replace(motion, rotations=rotations, translations=translations)


def _rough_on_the_way(motion: Motion, jumps: np.ndarray) -> np.ndarray:
    """The joints of the rig (frames, J) that are on the way to one of the twenty that jumps
    (frames, 20), and among the roughest on that way."""
    rough = np.zeros((len(motion), len(motion.skeleton.names)))
    for curve in curves_of(motion):
        rough[:, curve.joint] += curve.roughness()
    rough[:-1] = np.maximum(rough[:-1], rough[1:])
    there = np.zeros(rough.shape, bool)
    for column, joint in enumerate(rig_of(motion).joints):
        path = motion.skeleton.path(joint)
        roughest = rough[:, path].max(axis=1, keepdims=True)
        there[:, path] |= jumps[:, [column]] & (rough[:, path] >= ROUGH_SHARE * roughest)
    return there
