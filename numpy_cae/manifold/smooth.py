"""Removal of jitter from a motion: a zero-lag Butterworth filter whose cut-off is chosen from the
residual.

The filtered curve is ŷ = H y of y = x + white noise of variance σ². What it is expected to miss of
the true curve x follows from the residual alone (Stein's unbiased risk estimate, 1981):

    E mean (ŷ - x)² = E mean (y - ŷ)² - σ² + 2 σ² h_0,    h: the impulse response of the filter

σ² is estimated from the residual of a cut-off above which people hardly move. Of a range of
cut-offs, the one with the least estimate is used; without noise that is the highest.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from numpy_cae.motion.motion import Motion

CUT_OFFS = np.arange(1.0, 14.1, 0.5)
"""Hz that are tried, up to just below half of 30 frames a second."""
NOISE_FROM = 9.0
"""Hz above which everything is taken for noise."""
LEAST_FRAMES = 30
"""A shorter motion is not filtered."""


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
    found, missed, at_zero, kept = [], [], [], []
    for cut_off in cut_offs:
        lowpass = butter(2, cut_off, fs=rate, output="sos")
        found.append(sosfiltfilt(lowpass, smooth[:, moving], axis=0))
        missed.append(np.mean((found[-1] - smooth[:, moving]) ** 2, axis=(0, 2)))
        response = sosfiltfilt(lowpass, impulse)
        at_zero.append(response[500])
        kept.append(np.sum((impulse - response) ** 2))  # of white noise in the residual
    first = min(int(np.searchsorted(cut_offs, NOISE_FROM)), len(cut_offs) - 1)
    noise = missed[first] / kept[first]
    risk = np.array(missed) + 2 * noise * np.array(at_zero)[:, None]
    best = np.stack(found)[np.argmin(risk, axis=0), :, np.arange(len(moving))]
    smooth[:, moving] = best.transpose(1, 0, 2)
    return smooth
