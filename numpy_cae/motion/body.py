"""A take as the network wants it: twenty joints, thirty frames a second, from any motion file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from numpy_cae.motion.joints import UnknownRigError, body_positions
from numpy_cae.motion.load import load_motion
from numpy_cae.motion.motion import Motion

RATE = 30.0
"""Frames a second of holden2015, section 4."""


def body_of(motion: Motion, mapping: dict[str, str] | None = None) -> np.ndarray:
    """World positions of the twenty joints at `RATE`, (F, 20, 3) in metres."""
    return body_positions(motion.resampled(RATE), mapping)


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
