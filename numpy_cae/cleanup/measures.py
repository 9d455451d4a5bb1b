"""Measures of damage of a whole motion: frames that jump, feet that slide, jitter."""

from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.interpolation import with_finite_values
from numpy_cae.cleanup.view import SHARP, View
from numpy_cae.motion.motion import RATE, Motion

HIGHEST_RATE = 40.0
"""Jitter of a motion of more frames a second than this is measured at thirty."""


class Measures(NamedTuple):
    """Measures of damage of a motion, those of a body of usual size.

    Parameters
    ----------
    jumps : float
        The number of frames in which a joint jumps sharply.
    sliding : float
        How fast standing feet slide, centimetres a second.
    jitter : float
        How much joints shake (`measure_shaking`), metres a second squared.
    """

    jumps: float
    sliding: float
    jitter: float


def measure_damage(motion: Motion) -> Measures:
    """The measures of a motion, whose values need not be finite.

    Examples
    --------
    >>> from data_synth import make_take
    >>> measure_damage(make_take("walk", 0, seconds=2.0, rate=30.0).motion).jumps
    0.0
    """
    return measure_view(View(with_finite_values(motion)[0]))


def measure_view(view: View) -> Measures:
    """The measures of the motion of a view."""
    jumps = float(np.count_nonzero((view.jumps == SHARP).any(axis=1)))
    return Measures(jumps, view.sliding, measure_shaking(view))


def is_larger(before: float, after: float) -> bool:
    """Whether a measure is worse after a repair: larger by more than 1% and 0.1."""
    return after > 1.01 * before + 0.1


def measure_shaking(view: View) -> float:
    """The median change of a joint's acceleration from frame to frame, at most 30 a second, of a
    body of a person's size, in metres a second squared; where a pose is repeated nothing shakes."""
    if view.rate > HIGHEST_RATE:
        view = view.resampled(RATE)
    if len(view) < 4:
        return 0.0
    change = np.linalg.norm(np.diff(view.body, 3, axis=0), axis=-1) * view.rate**2
    return float(np.median(change[change > 0])) if change.any() else 0.0
