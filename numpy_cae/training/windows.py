"""Windows of frames, cut when they are read."""

import numpy as np


class Windows:
    """Windows of one array of frames, which are cut when they are read: those that overlap need no
    memory of their own.

    It is indexed like the array (N, T, C) of all windows, by a slice or an array of numbers, and
    gives a copy of these.

    Parameters
    ----------
    frames : (F, C) array
    starts : (N,) array of int
        The first frame of each window.
    length : int
        T.

    Attributes
    ----------
    shape, dtype
        Those of the array of all windows.

    Examples
    --------
    >>> windows = Windows(np.arange(10.0).reshape(5, 2), np.array([0, 1, 2]), length=3)
    >>> windows.shape, windows[1:2].tolist()
    ((3, 3, 2), [[[2.0, 3.0], [4.0, 5.0], [6.0, 7.0]]])
    """

    def __init__(self, frames: np.ndarray, starts: np.ndarray, length: int):
        self.frames = frames
        self.starts = starts
        self.shape = len(starts), length, frames.shape[1]
        self.dtype = frames.dtype

    def __len__(self) -> int:
        return len(self.starts)

    def __getitem__(self, numbers: slice | np.ndarray) -> np.ndarray:
        return self.frames[self.starts[numbers][:, None] + np.arange(self.shape[1])]
