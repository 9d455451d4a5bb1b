"""A take as the network wants it: twenty joints, thirty frames a second, from any motion file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import Akima1DInterpolator

from numpy_cae.motion.io.load import load_motion
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import UnknownRigError, body_positions

RATE = 30.0
"""Frames a second of holden2015, section 4."""


def body_of(motion: Motion, mapping: dict[str, str] | None = None) -> np.ndarray:
    """World positions of the twenty joints at `RATE`, (F, 20, 3) in metres."""
    return body_positions(motion.resampled(RATE), mapping)


def at_rate_of(motion: Motion, positions: np.ndarray) -> np.ndarray:
    """Positions at `RATE` brought to the frames of a motion: the way back from `body_of` in time.

    Between the poses runs Akima's modified cubic, smooth and local: where poses rest they stay at
    rest. Frames after the last pose, less than 1/30 s, go on as it went.

    Parameters
    ----------
    motion : Motion
        Its rate and length are wanted.
    positions : (F', N, 3) array of float
        As many poses as `body_of(motion)` has.

    Returns
    -------
    (F, N, 3) array of float64
        One pose for each frame of the motion.

    Raises
    ------
    ValueError
        If there are more poses or fewer.
    """
    moments = motion.source_frames(RATE)
    if len(positions) != len(moments):
        raise ValueError(
            f"{len(positions)} poses at {RATE:g} a second for a motion that has {len(moments)}"
        )
    frames = np.arange(len(motion))
    if len(moments) == 1:
        return np.repeat(positions, len(motion), axis=0)
    if np.array_equal(moments, frames):
        return np.array(positions, dtype=np.float64)
    moments = np.append(moments, 2 * moments[-1] - moments[-2])
    positions = np.concatenate([positions, 2 * positions[-1:] - positions[-2:-1]])
    return Akima1DInterpolator(moments, positions, method="makima")(frames)


def load_body(
    path: str | Path, mapping: dict[str, str] | None = None, unit: float | None = None
) -> tuple[np.ndarray, Motion]:
    """The twenty joints of a file at `RATE`, and the motion as the file has it.

    Raises
    ------
    MotionFileError
        If the file cannot be read.
    UnknownRigError
        With the file's name, if joints are missing.
    """
    motion = load_motion(path, unit=unit)
    try:
        return body_of(motion, mapping), motion
    except UnknownRigError as error:
        raise UnknownRigError(f"{path}: {error}") from None
