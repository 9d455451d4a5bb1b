"""Smooth functions of time: ramps, random drift, and transitions.

Every curve is a function of time in seconds, so that a motion can be sampled at any rate.
"""

from collections.abc import Callable

import numpy as np
from scipy.ndimage import convolve1d, maximum_filter1d

Curve = Callable[[np.ndarray], np.ndarray]


def ease(u: np.ndarray) -> np.ndarray:
    """Minimum-jerk transition from 0 to 1 for u from 0 to 1: 10u³ - 15u⁴ + 6u⁵.

    Hands and feet that move from rest to rest follow it closely (Flash & Hogan, 1985,
    *J. Neurosci.* 5:1688). Velocity and acceleration are 0 at both ends.
    """
    u = np.clip(u, 0.0, 1.0)
    return u**3 * (10 + u * (-15 + 6 * u))


def fade_out(since: np.ndarray, over: float = 0.18) -> np.ndarray:
    """s (1 - s/τ)², 0 from τ on: the path of a point that starts at speed 1 and stops."""
    return since * np.maximum(1 - since / over, 0.0) ** 2


def drift(
    rng: np.random.Generator, size: float, slowest: float = 0.1, fastest: float = 0.6
) -> Curve:
    """Random drift of standard deviation `size`: eight sines of random frequency and phase.

    Parameters
    ----------
    rng : numpy.random.Generator
    size : float
    slowest, fastest : float
        The band of frequencies, in Hz; slower ones are larger, as in quiet standing, whose
        sway falls off with frequency (Winter, 2009, chapter 11).
    """
    frequencies = np.exp(rng.uniform(np.log(slowest), np.log(fastest), 8))
    phases = rng.uniform(0, 2 * np.pi, 8)
    sizes = frequencies**-0.5
    sizes *= size * np.sqrt(2) / np.linalg.norm(sizes)

    def curve(t: np.ndarray) -> np.ndarray:
        angles = 2 * np.pi * frequencies * np.asarray(t)[..., None] + phases
        return np.sin(angles) @ sizes

    return curve


def smooth_over(need: np.ndarray, samples: float) -> np.ndarray:
    """A smooth curve that is never below `need`.

    It is the running maximum over a window, averaged over the same window.
    """
    width = 2 * int(samples / 2) + 3
    window = np.hanning(width + 2)[1:-1]
    highest = maximum_filter1d(need, width, mode="nearest")
    return convolve1d(highest, window / window.sum(), mode="nearest")


def limit_softly(values: np.ndarray, low: float, high: float, share: float = 0.1) -> np.ndarray:
    """Limit the values smoothly to the range from `low` to `high`.

    Values nearer to an end than `share` of the range are replaced by e + s tanh((x - e) / s).
    """
    slack = share * (high - low)
    over = np.maximum(values - (high - slack), 0.0)
    under = np.maximum(low + slack - values, 0.0)
    bent = np.clip(values, low + slack, high - slack)
    return bent + slack * (np.tanh(over / slack) - np.tanh(under / slack))
