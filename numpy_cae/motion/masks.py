"""Masks of frames and joints: their runs of consecutive frames, and their change of rate.

A mask is an array of bool: (frames,) or (frames, N) in the frames of a file, (F,) or (F, N) at
`RATE`, thirty frames a second. A run is a stretch of consecutive frames in which it is True.
"""

import sys

import numpy as np

from numpy_cae.motion.motion import RATE, Motion


def runs(mask: np.ndarray) -> np.ndarray:
    """The first frame and the end of each run of a mask (F,): (runs, 2) of int.

    Examples
    --------
    >>> runs(np.array([False, True, True, False, True])).tolist()
    [[1, 3], [4, 5]]
    """
    return np.flatnonzero(np.diff(mask, prepend=False, append=False)).reshape(-1, 2)


def run_numbers(mask: np.ndarray) -> np.ndarray:
    """For each True of a mask (F, N) the number of its run, from 1 on: (F, N) of int32, else 0."""
    begins = np.diff(mask, axis=0, prepend=False) & mask
    return np.cumsum(begins.T, dtype=np.int32).reshape(mask.T.shape).T * mask


def runs_with(mask: np.ndarray, some: np.ndarray) -> np.ndarray:
    """The runs of a mask (F, N) in which another mask is True somewhere: (F, N) bool."""
    numbers = run_numbers(mask)
    has_some = np.zeros(numbers.max(initial=0) + 1, bool)
    has_some[numbers[some & mask]] = True
    return has_some[numbers]


def distances_to_known(known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From each value (T, C) the frames back to the last known value of its column, and those on to
    the next one: 0 where it is known, far more than T where there is none.

    Examples
    --------
    >>> before, after = distances_to_known(np.array([[True], [False], [False], [True]]))
    >>> before.ravel().tolist(), after.ravel().tolist()
    ([0, 1, 2, 0], [0, 2, 1, 0])
    """
    frame = np.arange(len(known))[:, None]
    far = 1000 * len(known)
    before = frame - np.maximum.accumulate(np.where(known, frame, -far), axis=0)
    after = np.minimum.accumulate(np.where(known, frame, far)[::-1], axis=0)[::-1] - frame
    return before, after


def widen_runs(mask: np.ndarray, frames: int) -> np.ndarray:
    """A mask (F, N) with each run extended by this number of frames on both sides."""
    padded = np.pad(mask, ((frames + 1, frames), (0, 0)))
    count = np.cumsum(padded, axis=0, dtype=np.int32)
    return count[2 * frames + 1 :] > count[: -2 * frames - 1]


def at_thirty(motion: Motion, mask: np.ndarray) -> np.ndarray:
    """A mask (frames, N) of a motion's frames at `RATE`, (F, N).

    A frame is True if either neighbouring frame of the file is True.
    """
    source = motion.source_frames(RATE)
    before = np.floor(source).astype(int)
    after = np.minimum(np.ceil(source).astype(int), len(motion) - 1)
    return mask[before] | mask[after]


def fade_in_and_out(frames: int, stretch: slice, fade: float) -> np.ndarray:
    """A weight (frames,) that is 1 within a stretch, rises and falls over `fade` frames at its
    ends, and is 0 elsewhere; it does not fade where the motion begins or ends.

    Examples
    --------
    >>> fade_in_and_out(7, slice(2, 7), 1.0)
    array([0. , 0. , 0.5, 1. , 1. , 1. , 1. ])
    """
    frame = np.arange(frames)
    inside = (frame >= stretch.start) & (frame < stretch.stop)
    before = np.full(frames, np.inf) if stretch.start == 0 else frame - stretch.start + 1.0
    after = np.full(frames, np.inf) if stretch.stop == frames else stretch.stop - frame + 0.0
    fade = min(fade, sys.float_info.max)  # a product of seconds and a rate may be infinite
    u = np.clip(np.minimum(before, after) / (fade + 1.0), 0.0, 1.0)
    return np.where(inside, u * u * (3 - 2 * u), 0.0)
