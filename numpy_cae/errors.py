"""The base class of every error that this project raises for its users to read."""

from __future__ import annotations

from pathlib import Path

LONGEST = 700
"""Characters of a message; a name in a damaged file may be as long as the file."""


class NumpyCaeError(Exception):
    """An error whose message says what was wrong, where, and what to do about it.

    The command line prints the message of such an error, and of no other, without a traceback.
    """


class FileError(NumpyCaeError, ValueError):
    """A file that cannot be read or written as it stands.

    Parameters
    ----------
    path : path of the file
    line : int or None
        Counted from 1; None where the whole file is meant.
    problem : str
        What was found and what was expected.
    """

    def __init__(self, path: str | Path, line: int | None, problem: str):
        if len(problem) > LONGEST:
            problem = f"{problem[: LONGEST // 2]} … {problem[-LONGEST // 2 :]}"
        self.path, self.line, self.problem = Path(path), line, problem
        where = f"{path}:{line}" if line is not None else f"{path}"
        super().__init__(f"{where}: {problem}")

    def __reduce__(self):
        # Another process that read the file hands the error over in pieces.
        return type(self), (self.path, self.line, self.problem)
