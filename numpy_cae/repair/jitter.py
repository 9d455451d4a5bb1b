"""Removal of jitter: a zero-lag Butterworth filter for each joint, whose cut-off is chosen from the
residual.

The measured curve is y = x + white noise of variance σ², and the filtered curve is ŷ = H y. The
expected error of ŷ against the true curve x follows from the residual y - ŷ (Stein's unbiased risk
estimate, 1981), here with k = 1:

    E mean (ŷ - x)² = E mean (y - ŷ)² - σ² + 2 k σ² h_0,    h: the impulse response of the filter

σ² is estimated from the residual of the cut-off `NOISE_FROM`, above which people hardly move. Noise
of video has more power at low frequencies than white noise, therefore k is `COLOURED`. The cut-off
with the least estimated error is used. Without noise, this is the highest one.

Where joints still jump after that, the result is filtered again (`strongly_filtered`), and blended
into the rest on both sides. In a motion that is not filtered as a whole, this is done where joints
jump and are far from a smooth curve (`find_jumps`).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion.joints import JOINTS, joint_mask
from numpy_cae.motion.masks import runs, with_margin
from numpy_cae.motion.motion import Motion, blocks
from numpy_cae.motion.quaternions import slerp
from numpy_cae.repair.finding import BODY, Finding
from numpy_cae.repair.jumps import curves_of, off_cubic

CUT_OFFS = np.array([1, 1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 9, 11, 14])
"""CUT_OFFS: the cut-off frequencies (Hz) that are tried; the highest is just below half
of 30 frames a second."""
NOISE_FROM = 9.0
"""NOISE_FROM: the residual of this cut-off (Hz) is taken for noise."""
COLOURED = 2.0
"""COLOURED: k of the equation."""
RESPONSE = np.linspace(0.0, 0.4999, 1000)
"""RESPONSE: frequencies over which gains are averaged, in cycles a frame: h_0 is the mean gain."""
LEAST_FRAMES = 30
"""LEAST_FRAMES: a motion of fewer frames is not filtered."""
JUMP = 0.08
"""JUMP: a step jumps if it differs from the median of seven steps by more than this (m)."""
ROUNDS = 3
"""ROUNDS: the strong filter acts at most so often."""
FILTERED, AROUND = 0.25, 1.0
"""FILTERED, AROUND: the strong filter acts from FILTERED before a jump to FILTERED after it (s),
and is computed from AROUND before it to AROUND after it."""
ROUGH = JUMP / 2
"""ROUGH: a joint that jumps within a motion that is not filtered is further than this from a cubic
(m), as after a single step of `JUMP`. In 88 takes of Bandai without damage none is
(docs/lab_book/evidence.md)."""
SHARE = 0.2
"""SHARE: a rotation on the way to a joint that jumps is filtered if its roughness is at least this
part of the largest on the way."""


def find_jitter(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """One finding about the whole motion, of kind "jitter"."""
    return [Finding(BODY, (0, len(motion) - 1), "jitter", "the whole motion is smoothed")]


def smooth_motion(motion: Motion, findings: Sequence[Finding] = ()) -> Motion:
    """The motion without the jitter of its rotations and translations, in all frames."""
    smooth = filter_motion(motion, lambda curve: smooth_curve(curve, motion.rate))
    return _without_jumps(smooth, jumping_steps(smooth), motion)


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
    near = with_margin(rough[:, None] > ROUGH, 1)[:, 0]
    jumps = jumping_steps(motion, np.flatnonzero(near[:-1]), ROUGH / (2 * sensitivity))
    found = []
    for column in np.flatnonzero(jumps.any(axis=0)).tolist():
        joined = with_margin(jumps[:, [column]], round(FILTERED * motion.rate / 2))[:, 0]
        for first, end in runs(joined).tolist():
            at = first + np.flatnonzero(jumps[first:end, column])
            why = f"{len(at)} steps differ from those around them by more than {100 * JUMP:.0f} cm"
            found.append(Finding(JOINTS[column], (int(at[0]), int(at[-1])), "jumps", why))
    return found


def mend_jumps(motion: Motion, findings: Sequence[Finding]) -> Motion:
    """The motion with the joints of the findings filtered there."""
    jumps = np.zeros((len(motion), len(JOINTS)), bool)
    for finding in findings:
        joints = JOINTS if finding.joint == BODY else [finding.joint]
        jumps |= joint_mask(len(motion), joints, finding.stretch)
    return _without_jumps(motion, jumps)


def _without_jumps(motion: Motion, jumps: np.ndarray, source: Motion | None = None) -> Motion:
    """The motion with the joints that jump (frames, 20) filtered strongly around, and again where
    they still jump; first with the values of `source`, in which a jump is not smeared, if given."""
    for _ in range(ROUNDS if len(motion) >= LEAST_FRAMES else 0):
        some = np.asarray(jumps.any(axis=1, keepdims=True))
        near = with_margin(some, round(AROUND * motion.rate))[:, 0]
        rotations, translations = motion.rotations.copy(), motion.translations.copy()
        for first, end in runs(near).tolist():
            frames = slice(first, max(end, min(first + LEAST_FRAMES, len(motion))))
            part = _filtered_around(motion.at(frames), jumps[frames], (source or motion).at(frames))
            rotations[frames], translations[frames] = part.rotations, part.translations
        motion, source = replace(motion, rotations=rotations, translations=translations), None
        beside = with_margin(jumps, round(FILTERED * motion.rate))
        jumps = jumping_steps(motion, np.flatnonzero(near[:-1])) & beside
        if not jumps.any():
            break
    return motion


def filter_motion(motion: Motion, smooth: Callable[[np.ndarray], np.ndarray]) -> Motion:
    """The motion with each curve (F, C) of its rotations and of its translations filtered."""
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    for joint in range(rotations.shape[1]):
        q = rotations[:, joint]
        # q and -q are the same rotation: no jumps between them.
        dot = np.sum(q[1:] * q[:-1], axis=-1, keepdims=True)
        q[1:] *= np.cumprod(np.where(dot < 0, -1.0, 1.0), axis=0)
        for values in (rotations, translations):
            if np.ptp(values[:, joint], axis=0).max() > 1e-9:
                values[:, joint] = smooth(values[:, joint])
        rotations[:, joint] /= np.linalg.norm(q, axis=-1, keepdims=True)
    return replace(motion, rotations=rotations, translations=translations)


def smooth_curve(values: np.ndarray, rate: float) -> np.ndarray:
    """A curve (F, C) at `rate` frames a second, filtered with the cut-off that the module's
    equation chooses."""
    cut_offs = CUT_OFFS[CUT_OFFS < 0.48 * rate]
    if len(values) < LEAST_FRAMES or len(cut_offs) < 2:
        return values
    best, least, noise = values, np.inf, 0.0
    # From the highest cut-off down, beginning with the one whose residual is the noise.
    first = min(int(np.searchsorted(cut_offs, NOISE_FROM)), len(cut_offs) - 1)
    for cut_off in cut_offs[[first, *range(len(cut_offs))]]:
        filtered, gain = butterworth(values, cut_off, rate), gain_of(RESPONSE, cut_off / rate)
        residual = float(np.mean((filtered - values) ** 2))
        if noise == 0:  # the residual by the share of white noise that the filter removes
            noise = residual / float(np.mean((1 - gain) ** 2))
        risk = residual + 2 * COLOURED * noise * float(np.mean(gain))
        if risk < least:
            best, least = filtered, risk
    return best


def butterworth(values: np.ndarray, cut_off: float, rate: float) -> np.ndarray:
    """A curve (F, C) after a Butterworth filter of second order, forwards and backwards.

    The curve is extended by its own reflection about its first and its last point.
    """
    first, last = 2 * values[:1] - values[:0:-1], 2 * values[-1:] - values[-2::-1]
    extended = np.concatenate([first, values, last])
    gain = gain_of(np.fft.rfftfreq(len(extended)), cut_off / rate)
    filtered = np.fft.irfft(gain[:, None] * np.fft.rfft(extended, axis=0), len(extended), axis=0)
    return filtered[len(first) : len(first) + len(values)]


def gain_of(frequency: np.ndarray, cut_off: float) -> np.ndarray:
    """The squared gain of a Butterworth filter of second order, by the bilinear transform:
    1 / (1 + (tan πf / tan πc)⁴), f and c in cycles a frame."""
    return 1 / (1 + (np.tan(np.pi * frequency) / np.tan(np.pi * cut_off)) ** 4)


def strongly_filtered(values: np.ndarray, rate: float) -> np.ndarray:
    """A curve (F, C) after a median of 0.17 s and a Butterworth filter of 5 Hz."""
    return butterworth(median_of(values, round(0.17 * rate / 2)), min(5.0, 0.48 * rate), rate)


def median_of(values: np.ndarray, around: int) -> np.ndarray:
    """The median of each frame of (F, …) and as many frames before and after it."""
    padded = np.pad(values, ((around, around), *[(0, 0)] * (values.ndim - 1)), mode="edge")
    return np.median(sliding_window_view(padded, 2 * around + 1, axis=0), axis=-1)


def jumping_steps(
    motion: Motion, frames: np.ndarray | None = None, rough: float = 0.0
) -> np.ndarray:
    """The steps to the next frame that jump: those that differ by more than `JUMP` from the median
    of seven steps, (frames, 20) of bool.

    If `frames` are given, only these are looked at. If `rough` (m) is, a joint must also be further
    than this from the cubic through the two frames before it and the two after it.
    """
    jumps, joints = np.zeros((len(motion), len(JOINTS)), bool), rig_of(motion).joints
    for part in blocks(np.arange(len(motion) - 1) if frames is None else frames, 512):
        first = max(int(part[0]) - 3, 0)
        positions = motion.at(slice(first, part[-1] + 5)).positions(joints)
        steps = np.diff(positions, axis=0)
        steps -= median_of(steps, 3)
        off = np.linalg.norm(off_cubic(positions), axis=-1)
        jumps[part] = (np.linalg.norm(steps, axis=-1) > JUMP)[part - first]
        jumps[part] &= np.maximum(off[:-1], off[1:])[part - first] >= rough
    return jumps


def _filtered_around(motion: Motion, jumps: np.ndarray, source: Motion) -> Motion:
    """The motion with the rotations and translations of the joints on the way from the root to
    those that jump (frames, 20) those of `source` filtered around, as far as they are not smooth
    there."""
    rate, skeleton = motion.rate, motion.skeleton
    strong = filter_motion(source, lambda curve: strongly_filtered(curve, rate))
    rough = np.zeros((len(jumps), len(skeleton.names)))
    for curve in curves_of(source):
        rough[:, curve.joint] += curve.roughness()
    rough[:-1] = np.maximum(rough[:-1], rough[1:])
    moves = np.zeros(rough.shape, bool)
    for column, joint in enumerate(rig_of(motion).joints):
        path = skeleton.path(joint)
        counts = rough[:, path] >= SHARE * rough[:, path].max(axis=1, keepdims=True)
        moves[:, path] |= jumps[:, [column]] & counts
    near = with_margin(moves, round(FILTERED * rate))
    width = max(2 * round(FILTERED * rate / 2) + 1, 3)
    window = np.hanning(width + 2)[1:-1] / np.hanning(width + 2).sum()
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    for joint in np.flatnonzero(near.any(axis=0)).tolist():
        padded = np.pad(near[:, joint].astype(float), width // 2, "edge")
        share = np.convolve(padded, window, "valid")
        rotations[:, joint] = slerp(rotations[:, joint], strong.rotations[:, joint], share)
        change = strong.translations[:, joint] - translations[:, joint]
        translations[:, joint] += share[:, None] * change
    return replace(motion, rotations=rotations, translations=translations)
