"""Read many motion files in parallel, as the takes that a network learns from, or as windows."""

import os
import signal
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar, Unpack

import numpy as np

from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.mocap.load import LoadOptions, find_motion_files, load_body, matches_any
from numpy_cae.mocap.rigs.rigs import UnknownRigError
from numpy_cae.motion import LENGTH, OVERLAP, RATE, Note, cut_windows
from numpy_cae.motion.features import features_on_mean_skeleton

WORTHWHILE_BYTES = 20e6
"""Files of fewer bytes in all are read faster by one process than by several."""
MAX_STEP_METRES = 30.0
"""A take in which the hips move further (m) in a 30th of a second, or a joint is further from the
hips, is refused."""


Problem = MotionFileError | UnknownRigError
"""Why a motion file cannot be used."""
Take = TypeVar("Take")


def read_files(
    paths: Sequence[Path], read: Callable[[Path], Take], processes: int | None = None
) -> Iterator[Take | Problem]:
    """The result of `read` for each file, or why it refuses the file, in the order of `paths`.

    `processes` are by default one, or the number of processors for `WORTHWHILE_BYTES` bytes or
    more; `read` and what it returns are then pickled.
    """
    attempt = partial(_attempt, read)
    if processes is None:
        total = sum(path.stat().st_size for path in paths if path.exists())
        processes = (os.cpu_count() or 1) if total >= WORTHWHILE_BYTES else 1
    if processes == 1:
        yield from map(attempt, paths)
        return
    from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor  # slow to import

    pool = ProcessPoolExecutor(min(processes, len(paths)), initializer=_leave_interrupts)
    try:
        yield from pool.map(attempt, paths, chunksize=4)
    except BrokenProcessPool:
        raise OSError("a process that read motion files was ended from outside") from None
    finally:
        pool.shutdown(cancel_futures=True)


def _leave_interrupts() -> None:
    """Leave Ctrl-C to the process that started this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _attempt(read: Callable[[Path], Take], path: Path) -> Take | Problem:
    try:
        return read(path)
    except (MotionFileError, UnknownRigError) as problem:
        return problem


def read_body(path: Path, **options: Unpack[LoadOptions]) -> tuple[np.ndarray, tuple[Note, ...]]:
    """World positions (F, 20, 3) in metres at `RATE`, and the notes of the motion, as in
    `load_body`; frames that are not needed for that rate are not parsed."""
    options["max_rate"] = RATE
    positions, motion = load_body(path, **options)
    _require_steady(path, positions)
    return positions, motion.notes


def split_takes(
    takes: Iterable[tuple[Path, Take]], patterns: Sequence[str]
) -> tuple[list[Take], list[Take]]:
    """The takes to train on, and those to test on, whose file's name matches one of the patterns.

    Raises ValueError if a pattern matches no take, or none is left to train on.
    """
    takes = list(takes)
    for pattern in patterns:
        if not any(matches_any(path, [pattern]) for path, _ in takes):
            raise ValueError(f"no file that was read matches {pattern!r}, none is left to test on")
    training = [take for path, take in takes if not matches_any(path, patterns)]
    testing = [take for path, take in takes if matches_any(path, patterns)]
    if not training:
        raise ValueError(f"every file matches {' '.join(patterns)}, none is left to train on")
    return training, testing


def _require_steady(path: Path, positions: np.ndarray) -> None:
    """Raise MotionFileError if positions (F, 20, 3) jump so far that a network which learns from
    them would learn nothing else."""
    hips = positions[:, 0]
    steps = np.linalg.norm(np.diff(hips, axis=0), axis=-1)
    from_hips = np.linalg.norm(positions - hips[:, None], axis=-1).max(axis=1)
    _require_near(path, steps, "its hips move")
    _require_near(path, from_hips, "a joint is away from the hips by")


def _require_near(path: Path, metres: np.ndarray, problem: str) -> None:
    """Raise MotionFileError if a distance of `metres` (F,) is no person's."""
    if metres.size and not metres.max() <= MAX_STEP_METRES:
        problem = f"{problem} {metres.max():.3g} m in frame {metres.argmax()} (at 30 a second)"
        raise MotionFileError(path, None, f"{problem}, expected at most {MAX_STEP_METRES:g} m")


@dataclass(frozen=True, eq=False)
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
    paths = [path for path in find_motion_files(folder) if matches_any(path, [pattern])]
    if not paths:
        raise MotionFileError(folder, None, f"no motion file matches {pattern!r}")
    # Steps of a prime number visit the whole list, so that a part of it samples every kind.
    if len(paths) % 61:
        paths = [paths[i * 61 % len(paths)] for i in range(len(paths))]
    takes: list[np.ndarray] = []
    seconds = 0.0
    for path in paths:
        if seconds >= 60 * minutes:
            break
        takes.append(load_body(path)[0])
        seconds += len(takes[-1]) / RATE
    features, _ = features_on_mean_skeleton(takes, RATE)
    windows = []
    real = []
    numbers = []
    for number, take in enumerate(features):
        windows_of_take, real_of_take = cut_windows(take, length, overlap)
        windows.append(windows_of_take)
        real.append(real_of_take)
        numbers.append(np.full(len(real_of_take), number))
    return FileWindows(np.concatenate(windows), np.concatenate(real), np.concatenate(numbers))
