"""Read many motion files: in parallel, only the frames needed, and each file once.

The result of a file is cached under a hash of its content, so that a moved, renamed or copied file
is found again and a changed one is not. The folder of the cache can be deleted at any time.
"""

import hashlib
import json
import logging
import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, checked, load_arrays, save_arrays, word
from numpy_cae.errors import FileError
from numpy_cae.motion.formats.amc import find_skeleton
from numpy_cae.motion.formats.text_file import MotionFileError
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.read.coordinates import Coordinates
from numpy_cae.motion.read.load import load_body
from numpy_cae.motion.retarget.rigs import Mappings, UnknownRigError

log = logging.getLogger(__name__)

VERSION = "numpy_cae take 5"
"""Part of every hash: a change in the readers must change the version."""
WORTHWHILE = 20e6
"""Total bytes below which reading takes less than starting processes or looking into a cache."""

MAX_STEP = 30.0
"""Metres that the hips may move in a 30th of a second, and that a joint may be away from them."""


@dataclass(frozen=True)
class ReadResult:
    """The result of reading one file.

    World positions (F, 20, 3) in metres at `RATE`, None if the file cannot be used; a note on the
    unit that was assumed; the problem if there is one.
    """

    path: Path
    positions: np.ndarray | None
    note: str = ""
    problem: MotionFileError | UnknownRigError | None = None


def default_cache() -> Path | None:
    """The folder `numpy_cae` in the user's cache folder; None where the user has no home.

    Where the extra `cache` is installed, platformdirs knows the cache folder of each system.
    """
    try:
        from platformdirs import user_cache_path
    except ImportError:
        caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
        folder = Path(caches, "numpy_cae")
    else:
        try:
            folder = user_cache_path("numpy_cae", appauthor=False)
        except RuntimeError:  # no HOME and no entry in the list of users
            return None
    return folder if folder.is_absolute() else None


def read_bodies(
    paths: Sequence[Path],
    mapping: Mappings = None,
    coordinates: Coordinates | None = None,
    cache: Path | None = None,
    processes: int | None = None,
) -> Iterator[ReadResult]:
    """Each file as twenty joints at 30 frames a second, in the order of `paths`.

    The folder `cache` is created if missing; one that belongs to another user or cannot be written
    is not used, with a warning. `processes` are by default one, or the number of processors for
    `WORTHWHILE` bytes or more; the rest is as in `load_body`.
    """
    cache = _usable(cache)
    read = partial(_read, mapping=mapping, coordinates=coordinates or Coordinates(), cache=cache)
    if processes is None:
        processes = (os.cpu_count() or 1) if is_worthwhile(paths) else 1
    if processes == 1:
        yield from map(read, paths)
        return
    ends_at_sigterm = partial(signal.signal, signal.SIGTERM, signal.SIG_DFL)
    pool = ProcessPoolExecutor(min(processes, len(paths)), initializer=ends_at_sigterm)
    try:
        with _blocked_interrupts():
            bodies = pool.map(read, paths, chunksize=4)
        yield from bodies
    except BrokenProcessPool:
        raise OSError("a process that read motion files was ended from outside") from None
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def _blocked_interrupts() -> Iterator[None]:
    """Leave Ctrl-C to this process: the processes that it starts here inherit the block."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def is_worthwhile(paths: Sequence[Path]) -> bool:
    """Whether the files are large enough in total for processes and a cache."""
    return sum(path.stat().st_size for path in paths if path.exists()) >= WORTHWHILE


def _read(
    path: Path, mapping: Mappings, coordinates: Coordinates, cache: Path | None
) -> ReadResult:
    try:
        cached = None if cache is None else cache / f"{_hash(path, mapping, coordinates)}.npz"
        body = None if cached is None else _load(path, cached)
        if body is not None:
            return body
        positions, motion = load_body(path, mapping, coordinates, RATE)
        require_steady(path, positions)
    except (MotionFileError, UnknownRigError) as problem:
        return ReadResult(path, None, "", problem)
    if cached is not None:
        note = np.array(motion.unit_note)
        arrays = {"format": np.array(VERSION), "positions": positions, "note": note}
        with suppress(OSError, FileError):  # the take has been read already
            save_arrays(arrays, cached, compressed=False)
    return ReadResult(path, positions, motion.unit_note)


def require_steady(path: str | Path, positions: np.ndarray) -> None:
    """Raise MotionFileError if positions (F, 20, 3) jump so far that a network which learns from
    them would learn nothing else."""
    hips = positions[:, 0]
    steps = np.linalg.norm(np.diff(hips, axis=0), axis=-1)
    apart = np.linalg.norm(positions - hips[:, None], axis=-1).max(axis=1)
    for far, what in ((steps, "its hips move"), (apart, "a joint is away from the hips by")):
        if far.size and not far.max() <= MAX_STEP:
            problem = f"{what} {far.max():.3g} m in frame {far.argmax()} of 30 a second"
            raise MotionFileError(path, None, f"{problem}, expected at most {MAX_STEP:g} m")


def _hash(path: Path, mapping: Mappings, coordinates: Coordinates) -> str:
    """Equal for two files only if their content and the settings of the reader are equal."""
    how = [VERSION, RATE, mapping, vars(coordinates), path.suffix.lower()]
    settings = json.dumps(how, sort_keys=True)
    digest = hashlib.blake2b(settings.encode(), digest_size=20)
    files = [path, find_skeleton(path)] if path.suffix.lower() == ".amc" else [path]
    for file in files:
        try:
            data = file.read_bytes()
        except OSError as error:
            raise MotionFileError(file, None, f"cannot be read: {error.strerror}") from None
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()


def _usable(cache: Path | None) -> Path | None:
    """The folder, created if missing; None if it is not one that only this user writes to."""
    if cache is None:
        return None
    try:
        cache.mkdir(parents=True, exist_ok=True)
        problem = "" if os.access(cache, os.W_OK | os.X_OK) else "cannot be written"
        if hasattr(os, "getuid") and cache.stat().st_uid != os.getuid():
            problem = "belongs to another user"
    except OSError as error:
        problem = error.strerror or str(error)
    if problem:
        log.warning("%s: %s; this cache is not used", cache, problem)
    return None if problem else cache


def _load(path: Path, cached: Path) -> ReadResult | None:
    """The cached result; None if there is none, or, with a warning, if its file is damaged."""

    def body(arrays: dict[str, np.ndarray]) -> ReadResult:
        frames = len(arrays["positions"])
        positions = checked(arrays, "positions", (frames, 20, 3))
        return ReadResult(path, positions, word(arrays, "note"))

    try:
        return load_arrays(cached, {VERSION: body}) if os.path.lexists(cached) else None
    except ModelFileError as error:
        log.warning("%s; this entry of the cache is not used", error)
        return None
