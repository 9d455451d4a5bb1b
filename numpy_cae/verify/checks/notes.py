"""Notes: the warnings of a function that is checked, such as an overflow. They cost no points."""

import inspect
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from warnings import catch_warnings, simplefilter, warn

import numpy as np

from numpy_cae.verify.checks.written import error_text

MOST_NOTES = 5


@contextmanager
def noted(notes: list[str], file: str | None = None) -> Iterator[None]:
    """Add the warnings of a block to some notes, each once: those of one file, or of any file.

    A floating-point error is a warning, whatever np.seterr says; an underflow is none.
    """
    with catch_warnings(record=True) as caught, np.errstate(all="warn", under="ignore"):
        simplefilter("default")
        try:
            yield
        finally:
            of_file = (one for one in caught if file in (None, one.filename))
            texts = [f"{error_text(one.message)} (line {one.lineno})" for one in of_file]
            notes[:] = list(dict.fromkeys([*notes, *texts]))[:MOST_NOTES]


def file_of(function: Callable) -> str:
    """The file in which a function is written, or "" where this is unknown."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    return getattr(code, "co_filename", "")


def conclude(problems: Sequence[str], notes: Sequence[str]) -> None:
    """Raise an AssertionError with what is wrong and the notes; or warn of the notes alone."""
    lines = [f"note: {note}" for note in notes]
    if problems:
        raise AssertionError("\n".join([*problems, *lines]))
    for line in lines:
        warn(line, RuntimeWarning, stacklevel=3)
