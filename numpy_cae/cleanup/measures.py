"""Measures of damage of a whole motion: frames that jump, feet that slide, jitter."""

from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.channels import STILL_METRES, local_median
from numpy_cae.cleanup.interpolation import with_finite_values
from numpy_cae.cleanup.view import SHARP, View
from numpy_cae.motion.motion import RATE, Motion

HIGHEST_RATE = 40.0
"""Jitter of a motion of more frames a second than this is measured at thirty."""

KINK_METRES = 0.06
"""At a kink the step of a joint changes by more than this (m), and by more than
`KINK_METRES_A_SECOND_SQUARED` changes it in a frame."""
KINK_METRES_A_SECOND_SQUARED = 54.0
"""At a kink a joint has more than this acceleration (m/s²): at 30 frames a second both are one."""
KINK_TO_USUAL_RATIO = 6.0
"""At a kink the step changes by more than this times the median change over a second."""
KINK_TO_STEP_SHARE = 0.8
"""At a kink the step changes by more than this share of the longer one of both: the joint stops,
starts or turns back."""


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


def count_kinks(view: View) -> int:
    """In how many frames a joint stops, starts or turns back from one step to the next.

    Feet do so on the floor now and then; in noise joints do so all the time. Beside a pose that is
    repeated, as in animation on twos, nothing counts. docs/lab_book/evidence.md counts the kinks of
    many files with these constants.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[30:, 0] += [0.3, 0.0, 0.0]
    >>> count_kinks(View(motion))
    2
    """
    if len(view) < 3:
        return 0
    least = max(KINK_METRES, KINK_METRES_A_SECOND_SQUARED / view.rate**2)
    has_kink = np.zeros(len(view) - 2, bool)
    moves = np.zeros(len(view) - 1, bool)
    for joint in range(view.body.shape[1]):  # one after the other: an hour of all takes 0.5 GB
        steps = np.diff(view.body[:, joint], axis=0)
        change = np.linalg.norm(np.diff(steps, axis=0), axis=1)
        lengths = np.linalg.norm(steps, axis=1)
        longer = np.maximum(lengths[1:], lengths[:-1])
        is_kink = change > np.maximum(least, KINK_TO_STEP_SHARE * longer)
        if is_kink.any():
            is_kink &= change > KINK_TO_USUAL_RATIO * local_median(change, view.rate)
        has_kink |= is_kink
        moves |= lengths > STILL_METRES
    return int(np.count_nonzero(has_kink & moves[1:] & moves[:-1]))
