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
into the rest on both sides.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.manifold.evidence.finding import BODY, Finding
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.masks import with_margin
from numpy_cae.motion.motion import Motion, blocks
from numpy_cae.motion.quaternions import slerp
from numpy_cae.motion.retarget.rigs import find_joints

CUT_OFFS = np.array([1, 1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 9, 11, 14])
"""CUT_OFFS: the cut-off frequencies (Hz) that are tried; the highest is just below half
of 30 frames a second."""
NOISE_FROM = 9.0
"""NOISE_FROM: the residual of this cut-off (Hz) is taken for noise."""
COLOURED = 2.0
"""COLOURED: k of the equation."""
LEAST_FRAMES = 30
"""LEAST_FRAMES: a motion of fewer frames is not filtered."""
JUMP = 0.08
"""JUMP: a step jumps if it differs from the median of seven steps by more than this (m)."""
ROUNDS = 3
"""ROUNDS: the strong filter acts at most so often."""
FILTERED = 0.25
"""FILTERED: the strong filter acts from this time before a jump to this time after it (s)."""


def find_jitter(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """One finding about the whole motion, of kind "jitter"."""
    return [Finding(BODY, (0, len(motion) - 1), "jitter", "the whole motion is smoothed")]


def smooth_motion(motion: Motion, findings: Sequence[Finding] = ()) -> Motion:
    """The motion without the jitter of its rotations and translations, in all frames."""
    smooth = filter_motion(motion, lambda curve: smooth_curve(curve, motion.rate))
    for _ in range(ROUNDS if len(motion) >= LEAST_FRAMES else 0):
        jumps = jumping_steps(smooth)
        if not jumps.any():
            break
        strong = filter_motion(smooth, lambda curve: strongly_filtered(curve, motion.rate))
        smooth = _blended(smooth, strong, jumps)
    return smooth


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
    from scipy.signal import butter, sosfiltfilt  # slow to import, and seldom needed

    cut_offs = CUT_OFFS[CUT_OFFS < 0.48 * rate]
    if len(values) < LEAST_FRAMES or len(cut_offs) < 2:
        return values
    impulse = np.zeros(1001)
    impulse[500] = 1.0
    best, least, noise = values, np.inf, 0.0
    # From the highest cut-off down, beginning with the one whose residual is the noise.
    first = min(int(np.searchsorted(cut_offs, NOISE_FROM)), len(cut_offs) - 1)
    for cut_off in cut_offs[[first, *range(len(cut_offs))]]:
        lowpass = butter(2, cut_off, fs=rate, output="sos")
        filtered, response = (sosfiltfilt(lowpass, x, axis=0) for x in (values, impulse))
        residual = float(np.mean((filtered - values) ** 2))
        if noise == 0:  # the residual by the share of white noise that the filter removes
            noise = residual / float(np.sum((impulse - response) ** 2))
        risk = residual + 2 * COLOURED * noise * float(response[500])
        if risk < least:
            best, least = filtered, risk
    return best


def strongly_filtered(values: np.ndarray, rate: float) -> np.ndarray:
    """A curve (F, C) after a median of 0.17 s and a Butterworth filter of 5 Hz."""
    from scipy.ndimage import median_filter  # slow to import, and seldom needed
    from scipy.signal import butter, sosfiltfilt

    median = median_filter(values, (2 * round(0.17 * rate / 2) + 1, 1), mode="nearest")
    return sosfiltfilt(butter(2, min(5.0, 0.48 * rate), fs=rate, output="sos"), median, axis=0)


def jumping_steps(motion: Motion) -> np.ndarray:
    """The steps to the next frame that jump: those that differ by more than `JUMP` from the median
    of seven steps, (frames, 20) of bool."""
    from scipy.ndimage import median_filter  # slow to import, and seldom needed

    jumps, joints = np.zeros((len(motion), len(JOINTS)), bool), find_joints(motion.skeleton)
    for frames in blocks(np.arange(len(motion) - 1)):
        first = max(int(frames[0]) - 3, 0)
        steps = np.diff(motion.at(slice(first, frames[-1] + 5)).positions(joints), axis=0)
        steps -= median_filter(steps, (7, 1, 1), mode="nearest")
        jumps[frames] = np.linalg.norm(steps, axis=-1)[frames - first] > JUMP
    return jumps


def _blended(smooth: Motion, strong: Motion, jumps: np.ndarray) -> Motion:
    """`smooth`, and around jumps (frames, 20) the rotations and translations of `strong` of the
    joints on the way from the root to those that jump."""
    rate, skeleton = smooth.rate, smooth.skeleton
    moves = np.zeros((len(jumps), len(skeleton.names)), bool)
    for column, joint in enumerate(find_joints(skeleton)):
        for above in skeleton.path(joint):
            moves[:, above] |= jumps[:, column]
    near = with_margin(moves, round(FILTERED * rate))
    width = max(2 * round(FILTERED * rate / 2) + 1, 3)
    window = np.hanning(width + 2)[1:-1] / np.hanning(width + 2).sum()
    rotations, translations = smooth.rotations.copy(), smooth.translations.copy()
    for joint in np.flatnonzero(near.any(axis=0)).tolist():
        share = np.convolve(
            np.pad(near[:, joint].astype(float), width // 2, "edge"), window, "valid"
        )
        rotations[:, joint] = slerp(rotations[:, joint], strong.rotations[:, joint], share)
        change = strong.translations[:, joint] - translations[:, joint]
        translations[:, joint] += share[:, None] * change
    return replace(smooth, rotations=rotations, translations=translations)
