"""Windows from a folder of motion files, for lessons and short experiments."""

from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

import numpy as np

from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.mocap.load import find_motion_files, load_body
from numpy_cae.motion.lengths import features_on_mean_skeleton
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.windows import LENGTH, OVERLAP, cut_windows


@dataclass(frozen=True)
class FileWindows:
    """Windows (N, length, 63) on the mean skeleton of the files, not normalised.

    `real` (N, length) is False for frames added to a short take; `takes` (N,) is the index of each
    window's file.
    """

    features: np.ndarray
    real: np.ndarray
    takes: np.ndarray


def load_windows(
    folder: str | Path,
    pattern: str = "*",
    minutes: float = np.inf,
    length: int = LENGTH,
    overlap: int = OVERLAP,
) -> FileWindows:
    """The windows of the motion files below a folder.

    Parameters
    ----------
    folder : path
    pattern : str
        Names of the files to use, such as "*walk*".
    minutes : float
        Maximal duration; files are chosen evenly from the list.
    length, overlap : int
        Length and overlap of the windows, in frames at 30 a second.

    Returns
    -------
    FileWindows

    Raises
    ------
    MotionFileError, UnknownRigError
        If there is no such file, or one cannot be read or lacks joints.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import write_bvh
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> write_bvh(walk, "walk.bvh", unit=0.01)
    >>> load_windows(".", "walk*", length=32, overlap=16).features.shape
    (3, 32, 63)
    """
    paths = [path for path in find_motion_files(folder) if fnmatch(path.name, pattern)]
    if not paths:
        raise MotionFileError(folder, None, f"no motion file matches {pattern!r}")
    # Steps of a prime number visit the whole list, so that a part of it samples every kind.
    order = [paths[i * 61 % len(paths)] for i in range(len(paths))] if len(paths) % 61 else paths
    takes, seconds = [], 0.0
    for path in order:
        if seconds >= 60 * minutes:
            break
        takes.append(load_body(path)[0])
        seconds += len(takes[-1]) / RATE
    features, _ = features_on_mean_skeleton(takes, RATE)
    cut = [cut_windows(take, length, overlap) for take in features]
    return FileWindows(
        np.concatenate([windows for windows, _ in cut]),
        np.concatenate([real for _, real in cut]),
        np.concatenate([np.full(len(real), take) for take, (_, real) in enumerate(cut)]),
    )
