"""Windows of a motion, the input of a network (holden2015, section 4)."""

import numpy as np

from numpy_cae.motion.features import VELOCITY

LENGTH = 160
"""Frames in a window of the paper, 5.3 seconds at 30 frames a second."""
OVERLAP = 80
"""Frames that consecutive windows of the paper share."""


def cut_windows(
    features: np.ndarray, length: int = LENGTH, overlap: int = OVERLAP
) -> tuple[np.ndarray, np.ndarray]:
    """Overlapping windows that together cover every frame.

    They start every `length - overlap` frames; if frames remain at the end, one more window ends
    with the last frame. A take shorter than a window is extended by repeating its last pose;
    velocity and turn are 0 from its last frame on.

    Parameters
    ----------
    features : (F, 63) array of float
    length, overlap : int
        Numbers of frames, 0 <= overlap < length.

    Returns
    -------
    windows : (N, length, 63) array of float64
    real : (N, length) array of bool
        False for added frames, which are not counted in error measures.

    Raises
    ------
    ValueError
        If there are no frames or the overlap does not fit the length.

    Examples
    --------
    >>> windows, real = cut_windows(np.zeros((400, 63)))
    >>> windows.shape  # they start at frames 0, 80, 160 and 240
    (4, 160, 63)
    >>> windows, real = cut_windows(np.zeros((100, 63)))
    >>> windows.shape, int(real.sum())
    ((1, 160, 63), 100)
    """
    if not 0 <= overlap < length:
        problem = f"overlap is {overlap}, expected 0 to {length - 1} for windows of {length}"
        raise ValueError(problem)
    frames = len(features)
    if frames == 0:
        raise ValueError("features have no frames to cut windows from")
    if frames < length:
        held = np.repeat(features[-1:], length - frames, axis=0)
        window = np.concatenate([features, held])
        window[frames - 1 :, VELOCITY.start :] = 0.0
        return window[None], (np.arange(length) < frames)[None]
    starts = list(range(0, frames - length + 1, length - overlap))
    if starts[-1] + length < frames:
        starts.append(frames - length)
    windows = np.stack([features[start : start + length] for start in starts])
    return windows, np.ones(windows.shape[:2], dtype=bool)
