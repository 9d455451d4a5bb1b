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
    frames = len(features)
    features = extend_to_window(features, length)
    starts = window_starts(len(features), length, overlap)
    windows = np.stack([features[start : start + length] for start in starts])
    real = starts[:, None] + np.arange(length) < frames
    return windows, real


def extend_to_window(features: np.ndarray, length: int) -> np.ndarray:
    """Features (F, 63), of which a window of `length` frames can be cut: where they have fewer, the
    last pose is repeated, and velocity and turn are 0 from its last frame on."""
    frames = len(features)
    if frames == 0:
        raise ValueError("features have no frames to cut windows from")
    if frames >= length:
        return features
    held = np.repeat(features[-1:], length - frames, axis=0)
    extended = np.concatenate([features, held])
    extended[frames - 1 :, VELOCITY.start :] = 0.0
    return extended


def window_starts(frames: int, length: int, overlap: int) -> np.ndarray:
    """The first frame of each window of `cut_windows` of at least `length` frames."""
    if not 0 <= overlap < length:
        problem = f"overlap is {overlap}, expected 0 to {length - 1} for windows of {length}"
        raise ValueError(problem)
    starts = list(range(0, frames - length + 1, length - overlap))
    if starts[-1] + length < frames:
        starts.append(frames - length)
    return np.array(starts)
