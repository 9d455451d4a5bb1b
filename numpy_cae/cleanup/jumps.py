"""Noise: joints that jump from frame to frame, and jitter of the whole motion.

Where a joint jumps, the channels on the way to it that are not smooth are filtered strongly
(`filters.filter_strongly`), and the result is blended into the rest on both sides. The filter of
the whole motion smears single frames that jump, so these are filtered strongly after it, from the
values before it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.cleanup.finding import Finding, confidence
from numpy_cae.cleanup.kinds import BODY, JITTER, JUMPS
from numpy_cae.cleanup.measures import measure_shaking
from numpy_cae.cleanup.view import OFF_MEDIAN_METRES, SHARP, SHARP_METRES, View
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, Motion, filters
from numpy_cae.motion.contacts import FEET
from numpy_cae.motion.joints import joint_mask
from numpy_cae.motion.masks import runs, widen_runs
from numpy_cae.motion.quaternions import slerp

MOST_FILTERINGS = 3
"""The strong filter acts at most this often."""
BLENDED_SECONDS = 0.25
"""The strong filter acts from this time before a jump to this time after it (s)."""
FILTERED_SECONDS = 1.0
"""The strong filter is computed from this time before a jump to this time after it (s)."""
SHAKING = 0.1
"""A motion shakes if the acceleration of its joints changes by more than this from frame to frame,
in the median (m/s²)."""
ROUGHEST_SHARE = 0.2
"""A rotation on the way to a joint that jumps is filtered if its roughness is at least this share
of the largest on the way."""

KINK_SHARE = 0.75
"""A joint that is sharp at a 30th of a second, of n frames, moves on a smooth curve if n times the
largest change of its step is less than this share of the change at a 30th. It is 1 where the speed
changes within a frame, n where the place does, and 1.1 / n in a sine of 5 Hz; 3.5 to 4 in damaged
files of others, 0.3 to 0.75 in a front kick and in hops at 120 frames a second."""


def find_jumps(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """The times in which one of the twenty joints jumps from frame to frame, of kind "jumps".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[20:40:2, motion.skeleton.index("lwrist")] += 0.2
    >>> find_jumps(View(motion))
    [left_wrist: frames 19 to 38: jumps ...
    """
    levels = view.jump_levels(_rough_frames(view), sensitivity)
    sharp = levels == SHARP
    sparse, step = view.at_about_thirty()
    if step > 1:  # a joint that jumps within a 30th of a second does so in several frames
        of_sparse = sparse.jump_levels(_rough_frames(sparse), sensitivity) == SHARP
        _drop_smooth(of_sparse, view, sparse, step)
        sharp |= of_sparse.repeat(step, axis=0)[: len(view)]
    jumps = (levels > 0) | sharp
    findings = []
    for column in np.flatnonzero(sharp.any(axis=0)).tolist():
        joined = widen_runs(jumps[:, [column]], view.frames(BLENDED_SECONDS / 2))[:, 0]
        for first, end in runs(joined).tolist():
            if not sharp[first:end, column].any():
                continue
            at = first + np.flatnonzero(jumps[first:end, column])
            steps = "1 step differs" if len(at) == 1 else f"{len(at)} steps differ"
            centimetres = 100 * OFF_MEDIAN_METRES
            evidence = f"{steps} from the steps around by more than {centimetres:.0f} cm"
            frames = (int(at[0]), int(at[-1]))
            findings.append(Finding(JOINTS[column], frames, JUMPS.name, evidence))
    return findings


def _drop_smooth(is_sharp: np.ndarray, view: View, sparse: View, step: int) -> None:
    """Clear the steps of joints (sparse frames, 20) that are sharp at a 30th of a second, but whose
    joint moves on a smooth curve in all frames.

    On a smooth curve the change of the step grows with the square of the time of a step, where a
    speed changes within a frame only with that time.
    """
    for column in np.flatnonzero(is_sharp.any(axis=0)).tolist():
        change = np.linalg.norm(np.diff(view.body[:, column], 2, axis=0), axis=1)
        change = np.pad(change, (1, -(len(change) + 1) % step)).reshape(-1, step).max(axis=1)
        of_sparse = np.linalg.norm(np.diff(sparse.body[:, column], 2, axis=0), axis=1)
        for number in np.flatnonzero(is_sharp[:, column]).tolist():
            largest = change[max(number - 1, 0) : number + 2].max(initial=0.0)
            largest_of_sparse = of_sparse[max(number - 1, 0) : number + 1].max(initial=0.0)
            if step * largest < KINK_SHARE * largest_of_sparse:
                is_sharp[number, column] = False


def _rough_frames(view: View) -> np.ndarray:
    """The frames next to those in which a channel is rough."""
    rough = np.zeros(len(view))
    if len(view) >= filters.LEAST_FRAMES:
        for channel in view.channels:
            rough = rough + channel.roughness()
    return np.flatnonzero(widen_runs(rough[:, None] > SHARP_METRES, 1)[:-1])


def mend_jumps(view: View, findings: Sequence[Finding]) -> Motion:
    """The motion with the joints of the findings filtered there."""
    jumps = np.zeros((len(view), len(JOINTS)), bool)
    for finding in findings:
        joints = JOINTS if finding.joint == BODY else [finding.joint]
        jumps |= joint_mask(len(view), joints, finding.stretch)
    return filter_jumps(view, jumps)


def filter_jumps(view: View, jumps: np.ndarray, source: Motion | None = None) -> Motion:
    """The motion with the joints that jump (frames, 20) filtered strongly around, and again where
    they still jump; first with the values of `source`, in which a jump is not smeared, if given."""
    motion = view.motion
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    filtered = replace(motion, rotations=rotations, translations=translations)
    if len(motion) < filters.LEAST_FRAMES:
        return filtered
    margin = view.frames(FILTERED_SECONDS)
    blended = view.frames(BLENDED_SECONDS)
    for _ in range(MOST_FILTERINGS):
        near = widen_runs(jumps.max(axis=1, keepdims=True), margin)[:, 0]
        for first, end in runs(near).tolist():
            part = slice(first, max(end, min(first + filters.LEAST_FRAMES, len(motion))))
            values = filtered if source is None else source
            blend = _filter_around(filtered.at(part), jumps[part], values.at(part))
            rotations[part] = blend.rotations
            translations[part] = blend.translations
        source = filtered
        levels = view.after(filtered).jump_levels(np.flatnonzero(near[:-1]))
        jumps = (levels > 0) & widen_runs(jumps, blended)
        if not jumps.any():
            break
    return filtered


def _filter_around(motion: Motion, jumps: np.ndarray, source: Motion) -> Motion:
    """The motion with the rotations and translations of the joints on the way from the root to
    those that jump (frames, 20) those of `source` filtered around, as far as they are not smooth
    there."""
    strong = filters.filter_motion(source, lambda x: filters.filter_strongly(x, motion.rate))
    margin = round(BLENDED_SECONDS * motion.rate)
    near = widen_runs(_rough_on_the_way(View(source), jumps), margin)
    width = max(2 * round(BLENDED_SECONDS * motion.rate / 2) + 1, 3)
    window = np.hanning(width + 2)[1:-1] / np.hanning(width + 2).sum()
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    for joint in np.flatnonzero(near.any(axis=0)).tolist():
        share = np.convolve(np.pad(near[:, joint] + 0.0, width // 2, "edge"), window, "valid")
        rotations[:, joint] = slerp(rotations[:, joint], strong.rotations[:, joint], share)
        change = strong.translations[:, joint] - translations[:, joint]
        translations[:, joint] += share[:, None] * change
    return replace(motion, rotations=rotations, translations=translations)


def _rough_on_the_way(view: View, jumps: np.ndarray) -> np.ndarray:
    """The joints of the rig (frames, J) that are on the way to one of the twenty that jumps
    (frames, 20), and among the roughest on that way."""
    skeleton = view.motion.skeleton
    rough = np.zeros((len(view), len(skeleton.names)))
    for channel in view.channels:
        rough[:, channel.joint] += channel.roughness()
    rough[:-1] = np.maximum(rough[:-1], rough[1:])
    is_rough = np.zeros(rough.shape, bool)
    joints = rig_of(view.motion).joints
    for column, joint in enumerate(joints):
        path = skeleton.path(joint)
        roughest = rough[:, path].max(axis=1, keepdims=True)
        is_rough[:, path] |= jumps[:, [column]] & (rough[:, path] >= ROUGHEST_SHARE * roughest)
    # With the root the legs are filtered, too: else feet that stand would slide.
    legs: list[int] = []
    for toe in FEET:
        legs += skeleton.path(joints[toe])
    is_rough[:, legs] |= is_rough[:, skeleton.path(joints[0])].any(axis=1, keepdims=True)
    return is_rough


def find_jitter(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """One finding about the whole motion, of kind "jitter", if its joints shake and its rate
    lets noise and motion be separated."""
    ratio = measure_shaking(view) / SHAKING
    if ratio * 2 * sensitivity <= 1 or view.rate < filters.LEAST_RATE:
        return []
    evidence = f"joints shake by {SHAKING * ratio:.1f} m/s²; the whole motion is smoothed"
    frames = (0, len(view) - 1)
    return [Finding(BODY, frames, JITTER.name, evidence, confidence=confidence(ratio))]


def smooth_motion(view: View, findings: Sequence[Finding] = ()) -> Motion:
    """The motion without the jitter of its rotations and translations, in all frames."""
    rate = view.rate
    motion = filters.filter_motion(view.motion, lambda curve: filters.smooth_curve(curve, rate))
    smooth = view.after(motion)
    # A fast kick is not sharp and no jump; what was sharp is no longer so once it is filtered.
    sharp = (view.jumps == SHARP).any(axis=1, keepdims=True)
    near = widen_runs(sharp, view.frames(BLENDED_SECONDS))
    return filter_jumps(smooth, (smooth.jumps > 0) & near, view.motion)
