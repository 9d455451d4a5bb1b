"""Write a file wholly or not at all.

What is half written when a disk fills up or a person presses Ctrl-C must never stand in the place
of a good file, so it is written beside its place and moved there at the end.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path

from numpy_cae.errors import FileError


@contextmanager
def atomic_write(path: str | Path) -> Iterator[Path]:
    """A path beside `path`, of the same suffix, to write to; it is moved to `path` at the end.

    If the block raises, nothing is moved and what it wrote is removed.

    Raises
    ------
    FileError
        If the folder of `path` is missing, `path` is a folder, or writing fails.
    """
    path = Path(path)
    # os.path, unlike pathlib, has an answer for every name, too long ones included.
    if os.path.isdir(path):
        raise FileError(path, None, "cannot be written: there is a folder of this name")
    if not os.path.isdir(path.parent):
        raise FileError(path, None, f"cannot be written: there is no folder {path.parent}")
    beside = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield beside
        os.replace(beside, path)
    except OSError as error:
        raise FileError(path, None, f"cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            beside.unlink()


def remove_leftovers(path: str | Path) -> None:
    """Remove what processes that were killed left beside `path`; for its only writer to call."""
    path = Path(path)
    for left in path.parent.glob(f".{escape(path.stem)}.*.part{escape(path.suffix)}"):
        with suppress(OSError):
            left.unlink()
