"""Typical damage to motion data, with the ground truth.

The damage of holden2015, section 7: values set to zero, a missing marker, stepped animation; the
errors of a Kinect are in `kinect`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Rng = int | np.random.Generator


@dataclass(frozen=True)
class Damaged:
    """Damaged values and the true ones.

    Parameters
    ----------
    values : array
        After the damage; NaN where nothing is left.
    truth : array of the same shape
        Before the damage.
    known : array of bool of the same shape
        Where `values` still holds a measurement, possibly with noise.
    """

    values: np.ndarray
    truth: np.ndarray
    known: np.ndarray


def zero_values(values: np.ndarray, p: float, rng: Rng) -> Damaged:
    """Set each value to zero with probability p, independently.

    Parameters
    ----------
    values : array of float, any shape
        Positions or features; for centred values zero is the mean.
    p : float
        0 to 1; 0.1 for training, 0.5 in the paper's figure 1.
    rng : int or numpy.random.Generator

    Raises
    ------
    ValueError
        If p is no probability.

    References
    ----------
    holden2015, sections 6 and 7.
    """
    if not 0 <= p <= 1:
        raise ValueError(f"p is {p}, expected a probability from 0 to 1")
    known = np.random.default_rng(rng).random(values.shape) >= p
    return Damaged(np.where(known, values, 0.0), values.copy(), known)


def lose_marker(
    positions: np.ndarray,
    joints: int | Sequence[int],
    rng: Rng | None = None,
    gap: float | None = None,
    share: float = 0.5,
) -> Damaged:
    """Lose joints for the whole clip, or in gaps.

    Parameters
    ----------
    positions : (F, J, 3) array of float
    joints : int or sequence of int
        Such as ``JOINTS.index("left_wrist")``.
    rng : int or numpy.random.Generator
        For gaps only.
    gap : float, optional
        Mean length of a gap in frames; None loses the whole clip.
    share : float
        Of the frames that lie in gaps, on average.

    Returns
    -------
    Damaged
        NaN where lost.

    Raises
    ------
    ValueError
        If the positions are not (F, J, 3), a joint is not there, `gap` is below 1 frame or `share`
        not between 0 and gap / (gap + 1), or gaps are asked for without `rng`.

    References
    ----------
    holden2015, section 7 (the marker of a wrist).
    """
    _require_positions(positions)
    joints = np.atleast_1d(joints)
    if joints.min() < 0 or joints.max() >= positions.shape[1]:
        raise ValueError(f"joints are {joints.tolist()}, expected 0 to {positions.shape[1] - 1}")
    known = np.ones(positions.shape, dtype=bool)
    if gap is None:
        known[:, joints] = False
    else:
        if not (gap >= 1 and 0 < share < 1):
            raise ValueError(f"gap is {gap} and share {share}, expected at least 1, and 0 to 1")
        if share > gap / (gap + 1):
            raise ValueError(
                f"share is {share}, expected at most {gap / (gap + 1):.2f}: between two gaps of "
                f"{gap} frames at least one frame is seen"
            )
        if rng is None:
            raise ValueError("gaps are drawn: give rng")
        rng = np.random.default_rng(rng)
        for joint in joints:
            known[:, joint] = ~_gaps(len(positions), gap, share, rng)[:, None]
    return Damaged(np.where(known, positions, np.nan), positions.copy(), known)


def _gaps(frames: int, gap: float, share: float, rng: np.random.Generator) -> np.ndarray:
    """A two-state Markov chain: gaps of mean length `gap` that fill a `share` of the frames."""
    end, begin = 1 / gap, share / (1 - share) / gap
    lost = np.empty(frames, dtype=bool)
    state = rng.random() < share
    for frame, chance in enumerate(rng.random(frames)):
        lost[frame] = state
        state = chance >= end if state else chance < begin
    return lost


def hold_poses(positions: np.ndarray, every: int = 15) -> Damaged:
    """Stepped animation: every 15th frame is a key pose that is held until the next.

    Parameters
    ----------
    positions : (F, ...) array of float
        Positions or features, frames first.
    every : int
        Frames from one key to the next.

    Returns
    -------
    Damaged
        Known on the key frames.

    Raises
    ------
    ValueError
        If `every` is below 1.

    References
    ----------
    holden2015, section 7 ("stepped animation data using only every 15 frames").
    """
    if every < 1:
        raise ValueError(f"every is {every}, expected 1 frame or more")
    frames = np.arange(len(positions))
    known = np.zeros(positions.shape, dtype=bool)
    known[::every] = True
    return Damaged(positions[frames - frames % every], positions.copy(), known)


def _require_positions(positions: np.ndarray) -> None:
    if positions.ndim != 3 or positions.shape[2] != 3:
        raise ValueError(f"positions have shape {positions.shape}, expected (frames, joints, 3)")
