"""Removal of jitter from a motion: a zero-lag Butterworth filter whose cut-off is chosen from the
residual.

The measured curve is y = x + white noise of variance σ², and the filtered curve is ŷ = H y. The
expected error of ŷ against the true curve x follows from the residual y - ŷ (Stein's unbiased risk
estimate, 1981):

    E mean (ŷ - x)² = E mean (y - ŷ)² - σ² + 2 σ² h_0,    h: the impulse response of the filter

σ² is estimated from the residual of the cut-off `NOISE_FROM`, above which people hardly move. The
cut-off with the least estimated error is used. Without noise, this is the highest one.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from numpy_cae.motion.motion import Motion

CUT_OFFS = np.arange(1.0, 14.1, 0.5)
"""CUT_OFFS: the cut-off frequencies (Hz) that are tried; the highest is just below half
of 30 frames a second."""
NOISE_FROM = 9.0
"""NOISE_FROM: the residual of this cut-off (Hz) is taken for noise."""
LEAST_FRAMES = 30
"""LEAST_FRAMES: a motion of fewer frames is not filtered."""


def smooth_motion(motion: Motion) -> Motion:
    """The motion with the jitter of its rotations and translations removed; each joint has its own
    cut-off."""
    return filter_motion(motion, lambda curves: smooth_curves(curves, motion.rate))


def filter_motion(motion: Motion, smooth: Callable[[np.ndarray], np.ndarray]) -> Motion:
    """The motion with its curves (F, joints, C) of rotations and of translations filtered."""
    rotations = motion.rotations.copy()
    # q and -q are the same rotation: no jumps between them.
    dot = np.sum(rotations[1:] * rotations[:-1], axis=-1, keepdims=True)
    rotations[1:] *= np.cumprod(np.where(dot < 0, -1.0, 1.0), axis=0)
    rotations = smooth(rotations)
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    return replace(motion, rotations=rotations, translations=smooth(motion.translations))


def smooth_curves(values: np.ndarray, rate: float) -> np.ndarray:
    """Values (F, N, C) of N curves at `rate` frames a second, filtered."""
    from scipy.signal import butter, sosfiltfilt  # slow to import, and seldom needed

    smooth = np.array(values, dtype=np.float64)
    cut_offs = CUT_OFFS[CUT_OFFS < 0.48 * rate]
    if len(values) < LEAST_FRAMES or len(cut_offs) < 2:
        return smooth
    moving = np.flatnonzero(np.ptp(smooth, axis=0).max(axis=-1) > 1e-9)
    impulse = np.zeros(1001)
    impulse[500] = 1.0
    curves, missed, at_zero, removed = [], [], [], []
    for cut_off in cut_offs:
        lowpass = butter(2, cut_off, fs=rate, output="sos")
        curves.append(sosfiltfilt(lowpass, smooth[:, moving], axis=0))
        missed.append(np.mean((curves[-1] - smooth[:, moving]) ** 2, axis=(0, 2)))
        response = sosfiltfilt(lowpass, impulse)
        at_zero.append(response[500])
        removed.append(np.sum((impulse - response) ** 2))  # the share of white noise it removes
    first = min(int(np.searchsorted(cut_offs, NOISE_FROM)), len(cut_offs) - 1)
    noise = missed[first] / removed[first]
    risk = np.array(missed) + 2 * noise * np.array(at_zero)[:, None]
    best = np.stack(curves)[np.argmin(risk, axis=0), :, np.arange(len(moving))]
    smooth[:, moving] = best.transpose(1, 0, 2)
    return smooth
