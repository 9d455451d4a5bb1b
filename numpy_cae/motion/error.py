"""The one exception that a motion file can cause: which file, which line, what was expected."""

from __future__ import annotations

from pathlib import Path

LONGEST = 700
"""Letters of a complaint."""


class MotionFileError(ValueError):
    """A motion file that cannot be read as it stands.

    Parameters
    ----------
    path : path of the file
    line : int or None
        Counted from 1; None where the whole file is meant.
    problem : str
        What was found and what was expected.
    """

    def __init__(self, path: str | Path, line: int | None, problem: str):
        # A name in a damaged file may be as long as the file.
        if len(problem) > LONGEST:
            problem = f"{problem[: LONGEST // 2]} … {problem[-LONGEST // 2 :]}"
        self.path, self.line, self.problem = Path(path), line, problem
        where = f"{path}:{line}" if line is not None else f"{path}"
        super().__init__(f"{where}: {problem}")

    def __reduce__(self):
        # Another process that read the file hands the error over in pieces.
        return type(self), (self.path, self.line, self.problem)
