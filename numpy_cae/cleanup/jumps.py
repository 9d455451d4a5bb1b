"""Noise: joints that jump from frame to frame, and jitter of the whole motion.

Where a joint jumps, the curves on the way to it that are not smooth are filtered strongly
(`filters.filter_strongly`), and the result is blended into the rest on both sides. The filter of
the whole motion smears single frames that jump, so these are filtered strongly after it, from the
values before it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.cleanup.curves import at_about_thirty, body_size, curves_of, off_cubic
from numpy_cae.cleanup.finding import BODY, Finding, confidence
from numpy_cae.cleanup.presets import shaking
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, Motion, filters
from numpy_cae.motion.contacts import FEET
from numpy_cae.motion.joints import joint_mask
from numpy_cae.motion.masks import runs, widen_runs
from numpy_cae.motion.motion import blocks
from numpy_cae.motion.quaternions import slerp

OFF_MEDIAN_METRES = 0.08
"""OFF_MEDIAN_METRES: a step jumps if it differs from the median of seven steps by more than this
(m)."""
SHARP_METRES = OFF_MEDIAN_METRES / 2
"""SHARP_METRES: a joint that jumps within a motion that is not filtered is further than this from a
cubic (m), as after a single step of `OFF_MEDIAN_METRES`."""
SHARP_METRES_A_SECOND_SQUARED = 45.0
"""SHARP_METRES_A_SECOND_SQUARED: such a joint is also further from the cubic than this
acceleration (m/s²) moves it in the time of a frame."""
SHARPNESS_RATIO = 0.45
"""SHARPNESS_RATIO: such a joint is also further from the cubic than this times its largest step of
two frames around. After a frame that is elsewhere the ratio is 1, in noise about 1, where a joint
moves to another place within a step 0.5, where it stops within a frame 0.33; in fast motion at 24
to 30 frames a second it is mostly below 0.2."""
SHARP = 2
"""SHARP: the level of a step that jumps and is sharp (`jump_levels`)."""
ROUNDS = 3
"""ROUNDS: the strong filter acts at most this often."""
BLENDED_SECONDS = 0.25
"""BLENDED_SECONDS: the strong filter acts from so long before a jump to so long after it (s)."""
AROUND_SECONDS = 1.0
"""AROUND_SECONDS: the strong filter is computed from so long before a jump to so long after it
(s)."""
SHAKING = 0.1
"""SHAKING: a motion shakes if the acceleration of its joints changes by more than this from frame
to frame, in the median (m/s²)."""
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
    levels = jump_levels(motion, _rough_frames(motion), sensitivity)
    sharp = levels == SHARP
    sparse, step = at_about_thirty(motion)
    if step > 1:  # a joint that jumps within a 30th of a second does so in several frames
        of_sparse = jump_levels(sparse, _rough_frames(sparse), sensitivity) == SHARP
        sharp |= of_sparse.repeat(step, axis=0)[: len(motion)]
    jumps = (levels > 0) | sharp
    found = []
    for column in np.flatnonzero(sharp.any(axis=0)).tolist():
        joined = widen_runs(jumps[:, [column]], round(BLENDED_SECONDS * motion.rate / 2))[:, 0]
        for first, end in runs(joined).tolist():
            if not sharp[first:end, column].any():
                continue
            at = first + np.flatnonzero(jumps[first:end, column])
            steps = "1 step differs" if len(at) == 1 else f"{len(at)} steps differ"
            why = f"{steps} from the steps around by more than {100 * OFF_MEDIAN_METRES:.0f} cm"
            found.append(Finding(JOINTS[column], (int(at[0]), int(at[-1])), "jumps", why))
    return found


def _rough_frames(motion: Motion) -> np.ndarray:
    """The frames next to those in which a curve is rough."""
    curves = list(curves_of(motion)) if len(motion) >= filters.LEAST_FRAMES else []
    rough = sum((curve.roughness() for curve in curves), np.zeros(len(motion)))
    return np.flatnonzero(widen_runs(rough[:, None] > SHARP_METRES, 1)[:-1])


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
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    filtered = replace(motion, rotations=rotations, translations=translations)
    margin = round(AROUND_SECONDS * motion.rate)
    for _ in range(ROUNDS if len(motion) >= filters.LEAST_FRAMES else 0):
        near = widen_runs(jumps.max(axis=1, keepdims=True), margin)[:, 0]
        for first, end in runs(near).tolist():  # the filtered curves of an hour take 0.75 GB
            part = slice(first, max(end, min(first + filters.LEAST_FRAMES, len(motion))))
            done = _filtered_around(filtered.at(part), jumps[part], (source or filtered).at(part))
            rotations[part], translations[part] = done.rotations, done.translations
        source = filtered
        beside = widen_runs(jumps, round(BLENDED_SECONDS * motion.rate))
        jumps = (jump_levels(filtered, np.flatnonzero(near[:-1])) > 0) & beside
        if not jumps.any():
            break
    return filtered


def jump_levels(
    motion: Motion, frames: np.ndarray | None = None, sensitivity: float = 0.5
) -> np.ndarray:
    """How much the steps to the next frame jump, (frames, 20) of int: 0 not, 1 if they differ by
    more than `OFF_MEDIAN_METRES` from the median of seven steps, `SHARP` if, besides, their joint
    is off the cubic through the two frames before it and the two after it. If `frames` are given,
    only these are looked at."""
    levels = np.zeros((len(motion), len(JOINTS)), np.int8)
    least = max(SHARP_METRES, SHARP_METRES_A_SECOND_SQUARED / motion.rate**2) / (2 * sensitivity)
    joints = rig_of(motion).joints
    size = body_size(motion)
    for part in blocks(np.arange(len(motion) - 1) if frames is None else frames):
        first = max(int(part[0]) - 5, 0)
        positions = motion.at(slice(first, int(part[-1]) + 6)).positions(joints) / size
        steps = np.diff(positions, axis=0)
        jumping = np.linalg.norm(steps - filters.median_of(steps, 3), axis=-1) > OFF_MEDIAN_METRES
        off = np.linalg.norm(off_cubic(positions), axis=-1)
        lengths = np.pad(np.linalg.norm(steps, axis=-1), ((2, 2), (0, 0)))
        around = sliding_window_view(lengths, 5, axis=0).max(axis=-1)
        sharp = np.maximum(off[:-1], off[1:]) >= np.maximum(least, SHARPNESS_RATIO * around)
        levels[part] = (jumping * np.where(sharp, SHARP, 1))[part - first]
    return levels


def _filtered_around(motion: Motion, jumps: np.ndarray, source: Motion) -> Motion:
    """The motion with the rotations and translations of the joints on the way from the root to
    those that jump (frames, 20) those of `source` filtered around, as far as they are not smooth
    there."""
    strong = filters.filter_motion(source, lambda x: filters.filter_strongly(x, motion.rate))
    near = widen_runs(_rough_on_the_way(source, jumps), round(BLENDED_SECONDS * motion.rate))
    width = max(2 * round(BLENDED_SECONDS * motion.rate / 2) + 1, 3)
    window = np.hanning(width + 2)[1:-1] / np.hanning(width + 2).sum()
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    for joint in np.flatnonzero(near.any(axis=0)).tolist():
        share = np.convolve(np.pad(near[:, joint] + 0.0, width // 2, "edge"), window, "valid")
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
    # With the root the legs are filtered, too: else feet that stand would slide.
    joints = rig_of(motion).joints
    legs = [joint for toe in FEET for joint in motion.skeleton.path(joints[toe])]
    there[:, legs] |= there[:, motion.skeleton.path(joints[0])].any(axis=1, keepdims=True)
    return there


def find_jitter(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """One finding about the whole motion, of kind "jitter", if its joints shake and its rate
    lets noise and motion be separated."""
    shakes = shaking(motion) / SHAKING
    if shakes * 2 * sensitivity <= 1 or motion.rate < filters.LEAST_RATE:
        return []
    why = f"joints shake by {SHAKING * shakes:.1f} m/s²; the whole motion is smoothed"
    return [Finding(BODY, (0, len(motion) - 1), "jitter", why, confidence=confidence(shakes))]


def smooth_motion(motion: Motion, findings: Sequence[Finding] = ()) -> Motion:
    """The motion without the jitter of its rotations and translations, in all frames."""
    smooth = filters.filter_motion(motion, lambda curve: filters.smooth_curve(curve, motion.rate))
    # A fast kick is not sharp and no jump; what was sharp is no longer so once it is filtered.
    sharp = (jump_levels(motion) == SHARP).any(axis=1, keepdims=True)
    near = widen_runs(sharp, round(BLENDED_SECONDS * motion.rate))
    return without_jumps(smooth, (jump_levels(smooth) > 0) & near, motion)
