"""From a motion of any rig to the input of a network: twenty joints, thirty frames a second."""

from pathlib import Path

import numpy as np

from numpy_cae.motion.io.coordinates import Coordinates
from numpy_cae.motion.io.error import naming
from numpy_cae.motion.io.load import load_motion
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import Mappings, UnknownRigError, body_positions

RATE = 30.0
"""Frames a second of holden2015, section 4."""


def body_of(motion: Motion, mapping: Mappings = None) -> np.ndarray:
    """World positions of the twenty joints at `RATE`, (F, 20, 3) in metres."""
    return body_positions(motion.resampled(RATE), mapping)


def at_rate_of(motion: Motion, positions: np.ndarray) -> np.ndarray:
    """Positions at `RATE` resampled to the frames of a motion: the inverse of `body_of` in time.

    The interpolation is Akima's modified cubic, smooth and local: poses at rest stay at rest.
    Frames after the last pose, less than 1/30 s, are extrapolated linearly. Positions (F', N, 3)
    give (F, N, 3), a pose for each frame of the motion; ValueError unless they are as many poses as
    `body_of(motion)` has.
    """
    from scipy.interpolate import Akima1DInterpolator  # slow to import, and seldom needed

    times = motion.source_frames(RATE)
    if len(positions) != len(times):
        raise ValueError(
            f"{len(positions)} poses at {RATE:g} a second for a motion that has {len(times)}"
        )
    frames = np.arange(len(motion))
    if len(times) == 1:
        return np.repeat(positions, len(motion), axis=0)
    if np.array_equal(times, frames):
        return np.array(positions, dtype=np.float64)
    times = np.append(times, 2 * times[-1] - times[-2])
    positions = np.concatenate([positions, 2 * positions[-1:] - positions[-2:-1]])
    found = np.empty((len(frames), *positions.shape[1:]))
    for joint in range(positions.shape[1]):
        found[:, joint] = Akima1DInterpolator(times, positions[:, joint], method="makima")(frames)
    return found


def load_body(
    path: str | Path,
    mapping: Mappings = None,
    coordinates: Coordinates | None = None,
    max_rate: float | None = None,
) -> tuple[np.ndarray, Motion]:
    """The twenty joints of a file at `RATE`, and the motion at the rate of the file.

    What `coordinates` leaves open is detected; `max_rate` is as in `load_motion`.

    Raises MotionFileError if the file cannot be read; UnknownRigError, with the name of the file,
    if joints are missing.
    """
    known = vars(coordinates or Coordinates())
    motion = load_motion(path, max_rate=max_rate, mapping=mapping, **known)
    try:
        with naming(path):
            return body_of(motion, mapping), motion
    except UnknownRigError as error:
        raise UnknownRigError(f"{path}: {error}") from None
