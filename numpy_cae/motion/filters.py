"""Filters of curves: a zero-lag Butterworth filter whose cut-off is chosen from the residual.

The measured curve is y = x + white noise of variance σ², and the filtered curve is ŷ = H y. The
expected error of ŷ against the true curve x follows from the residual y - ŷ (Stein's unbiased risk
estimate, 1981), here with k = 1:

    E mean (ŷ - x)² = E mean (y - ŷ)² - σ² + 2 k σ² h_0,    h: the impulse response of the filter

σ² is estimated from the residual of the cut-off `NOISE_HERTZ`, above which people hardly move.
Noise of video has more power at low frequencies than white noise, therefore k is `COLOURED`. The
cut-off with the least estimated error is used. Without noise, this is the highest one.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.motion.motion import Motion

CUT_OFFS_HERTZ = np.array([1, 1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 9, 11, 14])
"""These cut-off frequencies (Hz) are tried; the highest is just below half of 30 frames a
second."""
HIGHEST_SHARE = 0.48
"""A cut-off is at most this share of the rate; at half of it the filter has no effect."""
LOWEST_HERTZ = 0.001
"""A cut-off is at least this frequency (Hz): at lower ones a curve becomes a straight line."""
NOISE_HERTZ = 9.0
"""The residual of this cut-off (Hz) is taken for noise."""
LEAST_RATE = 12.0
"""At fewer frames a second noise and motion look alike."""
COLOURED = 2.0
"""The factor k of the module's equation, for the noise of video."""
RESPONSE = np.linspace(0.0, 0.4999, 1000)
"""Gains are averaged over these frequencies, in cycles a frame: h_0 is the mean gain."""
LEAST_FRAMES = 30
"""A motion of fewer frames is not filtered."""
STRONG_SECONDS = 0.17
STRONG_HERTZ = 5.0
"""The strong filter is a median over this time (s) and a Butterworth filter of this cut-off
(Hz)."""

MEDIAN_VALUES = 1 << 22
"""`median_of` copies about this many values at a time: all windows of a long curve would fill the
memory."""


def filter_motion(motion: Motion, smooth: Callable[[np.ndarray], np.ndarray]) -> Motion:
    """The motion with each curve (F, C) of its rotations and of its translations filtered."""
    rotations = motion.rotations.copy()
    translations = motion.translations.copy()
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
    cut_offs = CUT_OFFS_HERTZ[CUT_OFFS_HERTZ < HIGHEST_SHARE * rate]
    if len(values) < LEAST_FRAMES or len(cut_offs) < 2:
        return values
    filtered = [butterworth(values, cut_off, rate) for cut_off in cut_offs]
    gains = [gain_of(RESPONSE, cut_off / rate) for cut_off in cut_offs]
    residuals = np.array([np.mean((curve - values) ** 2) for curve in filtered])
    first = min(int(np.searchsorted(cut_offs, NOISE_HERTZ)), len(cut_offs) - 1)
    # The residual by the share of white noise that the filter removes.
    noise = residuals[first] / np.mean((1 - gains[first]) ** 2)
    return filtered[int(np.argmin(residuals + 2 * COLOURED * noise * np.mean(gains, axis=1)))]


def butterworth(values: np.ndarray, cut_off: float, rate: float) -> np.ndarray:
    """A curve (F, C) after a Butterworth filter of second order, forwards and backwards.

    The curve is extended by its own reflection about its first and its last point. The cut-off
    (Hz) is at most `HIGHEST_SHARE` of the rate.
    """
    cut_off = min(cut_off, HIGHEST_SHARE * rate)
    count = len(values)
    # The Fourier transform of a length without large factors takes a tenth of the time.
    size = min(k << max((3 * count - 3) // k, 0).bit_length() for k in (4, 5, 6, 7))
    extended = np.pad(values, ((count - 1, count - 1), (0, 0)), "reflect", reflect_type="odd")
    extended = np.pad(extended, ((0, size - len(extended)), (0, 0)), "edge")
    gain = gain_of(np.fft.rfftfreq(size), cut_off / rate)
    filtered = np.fft.irfft(gain[:, None] * np.fft.rfft(extended, axis=0), size, axis=0)
    return filtered[count - 1 : 2 * count - 1]


def gain_of(frequency: np.ndarray, cut_off: float) -> np.ndarray:
    """The squared gain of a Butterworth filter of second order, by the bilinear transform:
    1 / (1 + (tan πf / tan πc)⁴), f and c in cycles a frame."""
    return 1 / (1 + (np.tan(np.pi * frequency) / np.tan(np.pi * cut_off)) ** 4)


def filter_strongly(values: np.ndarray, rate: float) -> np.ndarray:
    """A curve (F, C) after a median and a Butterworth filter."""
    return butterworth(median_of(values, round(STRONG_SECONDS * rate / 2)), STRONG_HERTZ, rate)


def median_of(values: np.ndarray, around: int) -> np.ndarray:
    """The median of each frame of (F, …) and as many frames before and after it."""
    padded = np.pad(values, ((around, around), *[(0, 0)] * (values.ndim - 1)), mode="edge")
    windows = sliding_window_view(padded, 2 * around + 1, axis=0)
    medians = np.empty(values.shape)
    frames = max(MEDIAN_VALUES * len(values) // max(windows.size, 1), 1)
    for first in range(0, len(values), frames):
        medians[first : first + frames] = np.median(windows[first : first + frames], axis=-1)
    return medians
