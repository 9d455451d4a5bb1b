"""What a check raises, for people and for programs, and how arrays are written in a message."""

import inspect
import os
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

NUMBER = "number"
SHAPE = "shape"
TYPE = "type"
COUNT = "count"
DTYPE = "dtype"
ALTERED = "altered"
NOT_FINITE = "not finite"
SLOPE = "slope"
KINK = "kink"
REPEATED = "repeated"
OVERWRITTEN = "overwritten"
STANDARD = Path(os.__file__).parent
LONGEST_TEXT = 2000
"""LONGEST_TEXT: a message has at most so many characters."""

WORTH_PRINTING = 32
"""Arrays of at most so many entries are printed in a counterexample."""
LONGEST_ARGUMENTS = 600
"""Arguments of at most so many characters are printed in a counterexample."""


@dataclass(eq=False)
class Mismatch(AssertionError):
    """A result that is not as expected: `kind` is one of the constants above.

    `subject` is what differs, such as "the gradient for x"; `result` and `expected` are the arrays,
    where there are any.
    """

    kind: str
    subject: str
    message: str
    result: np.ndarray | None = None
    expected: np.ndarray | None = None

    def __str__(self) -> str:
        return self.message


def what_failed(error: BaseException) -> tuple[str, str]:
    """The kind and the subject of a mismatch; of another assertion its type and its line."""
    if isinstance(error, Mismatch):
        return error.kind, error.subject
    frames = traceback.extract_tb(error.__traceback__) if type(error) is AssertionError else []
    return type(error).__name__, "".join(f"line {frame.lineno}" for frame in frames[-1:])


def written(value: object, digits: int = 6) -> str:
    """An argument or result as people write it: arrays as lists, no -0, short numbers."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key!r}: {written(one, digits)}' for key, one in value.items())}}}"
    if isinstance(value, list | tuple):
        inside = ", ".join(written(one, digits) for one in value)
        return f"[{inside}]" if isinstance(value, list) else f"({inside}{',' * (len(value) == 1)})"
    if not isinstance(value, np.ndarray):
        return f"{value + 0:.{digits}g}" if isinstance(value, float) else repr(value)
    if value.dtype.kind == "f":
        texts = [f"{v + 0:.{digits}g}" for v in value.flat]
        value = np.array(texts, float).reshape(value.shape)
    return str(value.tolist())


def written_apart(one: object, other: object, fewest: int = 6) -> tuple[str, str]:
    """Two numbers or arrays with so many digits that they are seen to differ, at most 17."""
    for digits in range(fewest, 18):
        texts = written(one, digits), written(other, digits)
        if texts[0] != texts[1]:
            break
    return texts


def described(thing: object) -> str:
    """What kind of thing this is, for a message."""
    if isinstance(thing, np.ndarray):
        return f"an array of {thing.dtype}, shape {thing.shape}"
    if isinstance(thing, tuple) and len(thing) <= 2:
        return f"a tuple of {' and '.join(map(described, thing))}"
    kind = "None: is a return missing?" if thing is None else type(thing).__name__
    return f"a {kind} of {len(thing)}" if isinstance(thing, tuple | list | dict) else kind


def file_of(function: Callable) -> str:
    """The file in which a function is written, or "" where this is unknown."""
    code = getattr(inspect.unwrap(function), "__code__", None)
    return getattr(code, "co_filename", "")


def error_text(error: BaseException, file: str = "") -> str:
    """Type, message and line of an exception, even if its __str__ raises."""
    try:
        text = f"{type(error).__name__}: {error}"[: LONGEST_TEXT // 2]
    except Exception:
        text = f"{type(error).__name__}, whose message cannot be printed"
    if isinstance(error, SystemExit):
        text = "it calls sys.exit"
    frames = traceback.extract_tb(error.__traceback__) if file else []
    foreign = [
        frame for frame in frames if frame.filename == file or not _is_library(frame.filename)
    ]
    if not foreign:
        return text
    name = "" if foreign[-1].filename == file else f"{Path(foreign[-1].filename).name}, "
    return f"{text} ({name}line {foreign[-1].lineno})"


def _is_library(file: str) -> bool:
    """Whether a file belongs to numpy_cae, NumPy, SciPy or the standard library."""
    path = Path(file)
    if not path.is_absolute():
        return True
    is_standard = STANDARD in path.parents and "site-packages" not in path.parts
    return is_standard or bool({"numpy", "scipy", "numpy_cae"} & {*path.parts})
