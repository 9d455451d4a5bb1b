"""The error that a motion file can cause: which file, which line, what was expected."""

from __future__ import annotations

from numpy_cae.errors import FileError


class MotionFileError(FileError):
    """A motion file that cannot be read."""
