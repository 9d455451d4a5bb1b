"""A lock that lets one process at a time write to a path.

It is the operating system's lock on a file beside the path, so it ends with the process that holds
it, even if that is killed: no stale lock has to be removed by hand.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from numpy_cae.errors import FileError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]
    import msvcrt


@contextmanager
def lock(path: str | Path) -> Iterator[None]:
    """Lock `path` for this process while the block runs.

    Raises
    ------
    FileError
        If another process holds the lock, or no file can be created beside the path.
    """
    path = Path(path)
    beside = path.with_name(f".{path.name}.lock")
    descriptor = _acquire(path, beside)
    try:
        yield
    finally:
        # Windows cannot remove an open file, POSIX must not remove one that another may hold.
        if fcntl is None:
            os.close(descriptor)
        with suppress(OSError):
            beside.unlink()
        if fcntl is not None:
            os.close(descriptor)


def _acquire(path: Path, beside: Path) -> int:
    while True:
        try:
            file = os.open(beside, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise FileError(path, None, f"cannot be written: {error.strerror}") from None
        try:
            if fcntl is None:
                msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
            else:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(file)
            raise FileError(
                path, None, "another process is writing to it; wait for its end or name another"
            ) from None
        # The holder before us may have removed the file between our opening and our locking it.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.stat(beside), os.fstat(file)):
                return file
        os.close(file)
