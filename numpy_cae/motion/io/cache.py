"""Many motion files as takes: in parallel, the wanted frames alone parsed, and each file once.

What a file came to is kept in a cache under a name made of its content, so that a file that was
moved, renamed or copied is known again, and one that was changed is not. Nothing of a cache need be
kept: deleting its folder costs time and no more.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.motion.io.amc import find_skeleton
from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.io.load import load_motion
from numpy_cae.motion.lengths import require_legs
from numpy_cae.motion.retarget.rigs import UnknownRigError, body_positions
from numpy_cae.motion.retarget.to_body import RATE

VERSION = "numpy_cae take 2"
"""Part of every name in a cache: another way of reading must bring another version."""
WORTHWHILE = 20e6
"""Bytes in all, below which reading takes less than starting processes or looking into a cache."""


@dataclass(frozen=True)
class Body:
    """What became of one file.

    Parameters
    ----------
    path : Path
    positions : (F, 20, 3) array of float64 or None
        World positions in metres at `RATE`; None where the file cannot be used.
    note : str
        What its unit was taken to be.
    problem : MotionFileError, UnknownRigError or None
    """

    path: Path
    positions: np.ndarray | None
    note: str = ""
    problem: MotionFileError | UnknownRigError | None = None


def default_cache() -> Path:
    """`numpy_cae` in the folder that the system keeps for caches."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "numpy_cae"


def read_bodies(
    paths: Sequence[Path],
    mapping: dict[str, str] | None = None,
    unit: float | None = None,
    cache: Path | None = None,
    processes: int | None = None,
) -> Iterator[Body]:
    """Each file as twenty joints at 30 frames a second, in the order of `paths`.

    Parameters
    ----------
    paths : sequence of paths
    mapping, unit
        As `load_body` takes them.
    cache : path, optional
        A folder, made if it is not there; None for none.
    processes : int, optional
        By default as many as there are processors for `WORTHWHILE` bytes or more, else one.
    """
    read = partial(_body, mapping=mapping, unit=unit, cache=cache)
    if processes is None:
        processes = (os.cpu_count() or 1) if is_worthwhile(paths) else 1
    if processes == 1:
        yield from map(read, paths)
        return
    pool = ProcessPoolExecutor(min(processes, len(paths)), initializer=_leave_ctrl_c_to_the_parent)
    try:
        yield from pool.map(read, paths, chunksize=4)
    except BrokenProcessPool:
        raise OSError("a process that read motion files was ended from outside") from None
    finally:
        pool.shutdown(cancel_futures=True)


def _leave_ctrl_c_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def is_worthwhile(paths: Sequence[Path]) -> bool:
    """Whether the files are many enough for processes and a cache."""
    total = 0
    for path in paths:
        total += path.stat().st_size if path.exists() else 0
        if total >= WORTHWHILE:
            return True
    return False


def _body(
    path: Path, mapping: dict[str, str] | None, unit: float | None, cache: Path | None
) -> Body:
    try:
        known = None if cache is None else cache / f"{_content(path, mapping, unit)}.npz"
        if known is not None and known.exists():
            body = _known(path, known)
            if body is not None:
                return body
        motion = load_motion(path, unit=unit, max_rate=RATE)
        try:
            positions = body_positions(motion.resampled(RATE), mapping)
        except UnknownRigError as error:
            raise UnknownRigError(f"{path}: {error}") from None
        require_legs(path, positions)
    except (MotionFileError, UnknownRigError) as problem:
        return Body(path, None, "", problem)
    if known is not None:
        _keep(known, positions, motion.unit_note)
    return Body(path, positions, motion.unit_note)


def _content(path: Path, mapping: dict[str, str] | None, unit: float | None) -> str:
    """The same for two files only if they say the same and are read in the same way."""
    settings = json.dumps([VERSION, RATE, mapping, unit, path.suffix.lower()], sort_keys=True)
    digest = hashlib.blake2b(settings.encode(), digest_size=20)
    files = [path, find_skeleton(path)] if path.suffix.lower() == ".amc" else [path]
    for file in files:
        try:
            data = file.read_bytes()
        except OSError as error:
            raise MotionFileError(file, None, f"cannot be read: {error.strerror}") from None
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()


def _known(path: Path, known: Path) -> Body | None:
    """What the cache says; None where its file is damaged, to be made anew."""
    try:
        with np.load(known, allow_pickle=False) as file:
            positions, note = file["positions"], str(file["note"])
    except Exception:  # whatever np.load raises of a damaged archive
        return None
    whole = positions.ndim == 3 and positions.shape[1:] == (20, 3) and len(positions) > 0
    return Body(path, positions, note) if whole and np.isfinite(positions).all() else None


def _keep(known: Path, positions: np.ndarray, note: str) -> None:
    """A cache that cannot be written is none: the take has been read all the same."""
    try:
        known.parent.mkdir(parents=True, exist_ok=True)
        archive = io.BytesIO()  # see Checkpoint.save
        np.savez(archive, positions=positions, note=np.array(note))
        with atomic_write(known) as beside:
            beside.write_bytes(archive.getbuffer())
    except (OSError, MotionFileError):
        return
