"""Write a file completely or not at all.

A file that is half written when the disk fills up or the process is killed must never replace a
good one. So the file is written under a temporary name in the same folder, brought to the disk
(fsync) and then renamed, which the operating system does in one step. A process that is killed
while it writes leaves the temporary file, `.NAME.PROCESS.part.SUFFIX`, which the next writing of
the same file removes.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from numpy_cae.errors import FileError

LONGEST_NAME = 50
"""The temporary name has at most so many characters of the name: systems allow 255 bytes in all."""


@contextmanager
def atomic_write(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path to write to, of the same suffix; rename it to `path` at the end.

    If the block raises an exception, `path` is unchanged and the temporary file is removed.

    Raises
    ------
    FileError
        If the folder of `path` is missing, `path` is a folder, or writing fails.
    """
    path = Path(path)
    require_place(path)
    begin = f".{path.stem[:LONGEST_NAME]}."
    end = f".part{path.suffix}"
    temporary = path.with_name(f"{begin}{os.getpid()}{end}")
    try:
        _remove_leftovers(path.parent, begin, end)
        yield temporary
        with temporary.open("r+b") as file:
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        raise FileError(path, None, f"cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def require_place(path: Path) -> None:
    """Raise FileError if the folder of `path` is missing, or `path` is a folder."""
    # os.path returns False for names that are too long, where pathlib raises.
    if os.path.isdir(path):
        raise FileError(path, None, "cannot be written: there is a folder of this name")
    if not os.path.isdir(path.parent):
        raise FileError(path, None, f"cannot be written: there is no folder {path.parent}")


def _remove_leftovers(folder: Path, begin: str, end: str) -> None:
    """Remove the temporary files of these names whose process has ended."""
    for name in os.listdir(folder):
        process = name[len(begin) : -len(end)]
        if name == f"{begin}{process}{end}" and process.isdecimal() and has_ended(int(process)):
            with suppress(OSError):
                (folder / name).unlink()


def has_ended(process: int) -> bool:
    """Whether no process has this number; False where that cannot be asked (Windows)."""
    if os.name != "posix":
        return False
    try:
        os.kill(process, 0)
    except (OSError, OverflowError) as error:
        return not isinstance(error, PermissionError)  # which a process of another user raises
    return False
