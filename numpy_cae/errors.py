"""The base classes of the errors that this project raises for its users to read."""

from pathlib import Path

from numpy_cae.visible import visible

MAX_CHARACTERS = 700
"""Of a message; a name in a damaged file may be as long as the file."""


class NumpyCaeError(Exception):
    """An error whose message says what is wrong, where, and what to do about it.

    The command line prints the message of such an error without a traceback.
    """


class FileError(NumpyCaeError, ValueError):
    """A file that cannot be read or written.

    Parameters
    ----------
    path : path of the file
    line : int or None
        Counted from 1; None for the whole file.
    problem : str
        What was found and what was expected.
    """

    def __init__(self, path: str | Path, line: int | None, problem: str):
        if len(problem) > MAX_CHARACTERS:
            problem = f"{problem[: MAX_CHARACTERS // 2]} … {problem[-MAX_CHARACTERS // 2 :]}"
        self.path = Path(path)
        self.line = line
        self.problem = problem
        name = visible(str(path)).replace("\n", "\\n")
        where = f"{name}:{line}" if line is not None else name
        super().__init__(visible(f"{where}: {problem}"))

    def __reduce__(self):
        # So that the error can be pickled, in a process that reads files for another.
        return type(self), (self.path, self.line, self.problem)
