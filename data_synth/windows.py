"""Windows of the 63 features of holden2015 from synthetic takes, in memory."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from data_synth.series import Plan, plan_takes
from numpy_cae.motion import bone_lengths, change_lengths, cut_windows, positions_to_features

_RATE = 30.0
_BODY = (
    "root upperback thorax head lclavicle lhumerus lradius lwrist rclavicle rhumerus rradius "
    "rwrist lfemur ltibia lfoot ltoes rfemur rtibia rfoot rtoes"
).split()
"""The names of `numpy_cae.motion.JOINTS` in the skeleton of a take."""


@dataclass(frozen=True, eq=False)
class Windows:
    """Windows of features and their sources.

    Parameters
    ----------
    features : (N, length, 63) array of float64
        As `numpy_cae.motion.positions_to_features` lays them out: metres, metres and radians a
        frame; no mean subtracted.
    real : (N, length) array of bool
        False on frames that hold the last pose of a take shorter than a window.
    kinds, styles : lists of N str
    takes : (N,) array of int
        The number of the take that each window was cut from.
    lengths : (20,) array
        The bone lengths in metres of all windows: the mean of the takes.
    """

    features: np.ndarray
    real: np.ndarray
    kinds: list[str]
    styles: list[str]
    takes: np.ndarray
    lengths: np.ndarray


def make_windows(
    minutes: float,
    seed: int = 0,
    kinds: Sequence[str] | None = None,
    length: int = 160,
    overlap: int = 80,
) -> Windows:
    """Windows of `minutes` of motion at 30 frames a second (holden2015, section 4).

    Parameters
    ----------
    minutes : float
    seed : int
    kinds : sequence of str, optional
    length, overlap : int
        In frames.

    Raises
    ------
    ValueError
        As `plan_takes` and `numpy_cae.motion.cut_windows` do.
    """
    return windows_of(plan_takes(minutes, seed, kinds), length, overlap)


def windows_of(plans: Sequence[Plan], length: int = 160, overlap: int = 80) -> Windows:
    """The windows of planned takes, such as `plan_cmu_scale()`.

    The 9673 windows of `plan_cmu_scale()` need 0.8 GB, and 2.1 GB while they are made.
    """
    if not plans:
        raise ValueError("there are no takes to cut windows from")
    # Only twenty of the thirty-one joints of each take stay in memory.
    bodies = []
    named = []
    for plan in plans:
        take = plan.make(_RATE)
        joints = [take.motion.skeleton.index(name) for name in _BODY]
        bodies.append(take.motion.positions(joints))
        named.append((take.kind, take.style, plan.number))
    lengths_of_bodies = [bone_lengths(body) for body in bodies]
    mean_lengths = np.mean(lengths_of_bodies, axis=0)
    cut = []
    real = []
    kinds = []
    styles = []
    numbers = []
    for (kind, style, number), body, lengths in zip(named, bodies, lengths_of_bodies, strict=True):
        features, _ = positions_to_features(change_lengths(body, lengths, mean_lengths), _RATE)
        windows, shown = cut_windows(features, length, overlap)
        cut.append(windows)
        real.append(shown)
        kinds += [kind] * len(windows)
        styles += [style] * len(windows)
        numbers += [number] * len(windows)
    return Windows(
        np.concatenate(cut), np.concatenate(real), kinds, styles, np.array(numbers), mean_lengths
    )
