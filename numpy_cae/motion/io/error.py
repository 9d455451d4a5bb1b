"""The error that a motion file can cause: which file, which line, what was expected."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from numpy_cae.errors import FileError, NumpyCaeError


class MotionFileError(FileError):
    """A motion file that cannot be read."""


@contextmanager
def naming(path: str | Path) -> Iterator[None]:
    """Turn any unexpected exception of the block into a `MotionFileError` that names the file, so
    that one strange file does not end the reading of thousands."""
    try:
        yield
    except NumpyCaeError:
        raise
    except Exception as error:
        problem = f"cannot be read: {type(error).__name__}: {error}"
        raise MotionFileError(path, None, " ".join(problem.split())) from error
