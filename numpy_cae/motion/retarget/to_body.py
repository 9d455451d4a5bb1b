"""From a motion of any rig to the input of a network: twenty joints, thirty frames a second."""

import numpy as np

from numpy_cae.motion.motion import RATE, Motion, blocks
from numpy_cae.motion.retarget.rigs import body_positions


def body_of(motion: Motion) -> np.ndarray:
    """World positions of the twenty joints at thirty frames a second (`RATE`).

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.

    Returns
    -------
    (F, 20, 3) array of float64
        Metres.

    Raises
    ------
    UnknownRigError
        If joints are missing, or the bones are not a person's.

    Examples
    --------
    >>> from data_synth import make_take
    >>> body_of(make_take("walk", 1, seconds=2.0, rate=120.0).motion).shape
    (60, 20, 3)
    """
    return body_positions(motion.resampled(RATE))


def at_rate_of(
    motion: Motion, positions: np.ndarray, frames: np.ndarray | None = None
) -> np.ndarray:
    """Positions at `RATE` resampled to the frames of a motion: the inverse of `body_of` in time.

    The interpolation is Akima's modified cubic, smooth and local: poses at rest stay at rest.
    Frames after the last pose, less than 1/30 s, are extrapolated linearly.

    Parameters
    ----------
    motion : Motion
    positions : (F', N, 3) array of float
        As many poses as `body_of(motion)` has.
    frames : (F,) array of int, optional
        Frames of the motion, ascending; all by default.

    Returns
    -------
    (F, N, 3) array of float64

    Raises
    ------
    ValueError
        If the number of poses is another.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> positions = body_of(walk)
    >>> len(positions), len(at_rate_of(walk, positions))
    (60, 240)
    """
    from scipy.interpolate import Akima1DInterpolator  # slow to import, and seldom needed

    times = motion.source_frames(RATE)
    if len(positions) != len(times):
        raise ValueError(
            f"{len(positions)} poses at {RATE:g} a second for a motion that has {len(times)}"
        )
    frames = np.arange(len(motion)) if frames is None else frames
    found = np.empty((len(frames), *positions.shape[1:]))
    if len(times) == 1 or np.array_equal(times, np.arange(len(motion))):
        found[:] = positions[0 if len(times) == 1 else frames]
        return found
    step = times[1]
    for part in blocks(np.arange(len(frames))):
        # The curve of some frames depends on three poses before them and three after them.
        first, end = (frames[part[[0, -1]]] / step).astype(int) + [-3, 5]
        near = positions[max(first, 0) : end]
        if end > len(times):
            near = np.concatenate([near, 2 * near[-1:] - near[-2:-1]])
        own = step * (max(first, 0) + np.arange(len(near)))
        found[part] = Akima1DInterpolator(own, near, method="makima")(frames[part])
    return found
