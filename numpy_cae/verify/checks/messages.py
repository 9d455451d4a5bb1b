"""Arrays, types and errors as text, for the messages of checks."""

import inspect
import os
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

WORTH_PRINTING = 32
"""Arrays of at most this many entries are printed in a counterexample."""
LONGEST_ARGUMENTS = 600
"""Arguments of at most this many characters are printed in a counterexample."""


def as_text(value: Any, digits: int = 6) -> str:
    """An argument or result as people write it: arrays as lists, no -0, short numbers."""
    if isinstance(value, dict):
        items = [f"{key!r}: {as_text(entry, digits)}" for key, entry in value.items()]
        return f"{{{', '.join(items)}}}"
    if isinstance(value, list | tuple):
        inside = ", ".join(as_text(entry, digits) for entry in value)
        if isinstance(value, list):
            return f"[{inside}]"
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    if isinstance(value, float):
        return f"{value + 0:.{digits}g}"
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.dtype.kind == "f":
        texts = [f"{number + 0:.{digits}g}" for number in value.flat]
        value = np.array(texts, float).reshape(value.shape)
    return str(value.tolist())


MOST_DIGITS = 17
"""So many digits tell any two numbers of float64 from each other."""


def texts_that_differ(first: object, second: object, fewest: int = 6) -> tuple[str, str]:
    """Two numbers or arrays with so many digits that they are seen to differ, at most 17."""
    texts = (as_text(first, fewest), as_text(second, fewest))
    for digits in range(fewest + 1, MOST_DIGITS + 1):
        if texts[0] != texts[1]:
            break
        texts = (as_text(first, digits), as_text(second, digits))
    return texts


def describe(thing: object) -> str:
    """What kind of thing this is, for a message."""
    if isinstance(thing, np.ndarray):
        return f"an array of {thing.dtype}, shape {thing.shape}"
    if isinstance(thing, tuple) and len(thing) <= 2:
        return f"a tuple of {' and '.join(map(describe, thing))}"
    if thing is None:
        return "a None: is a return missing?"
    kind = type(thing).__name__
    return f"a {kind} of {len(thing)}" if isinstance(thing, tuple | list | dict) else kind


def file_of(function: Callable) -> str:
    """The file in which a function is written, or "" where this is unknown."""
    function = inspect.unwrap(function)
    code = getattr(function, "__code__", None)
    return getattr(function, "remote_file", getattr(code, "co_filename", ""))


LONGEST_TEXT = 2000
"""A message has at most this many characters."""


def error_text(error: BaseException, file: str = "", is_file_named: bool = False) -> str:
    """Type, message and line of an exception, even if its __str__ raises.

    The line of another file than this one has the name of its file; with `is_file_named` each has.
    """
    try:
        text = f"{type(error).__name__}: {error}"[: LONGEST_TEXT // 2]
    except Exception:
        text = f"{type(error).__name__}, whose message cannot be printed"
    if isinstance(error, SystemExit):
        text = "it calls sys.exit"
    if not file:
        return text
    own_frames = []
    for filename, line in frames_of(error):
        if filename == file or not _is_library(filename):
            own_frames.append((filename, line))
    if not own_frames:
        return text
    filename, line = own_frames[-1]
    name = f"{Path(filename).name}, "
    if filename == file and not is_file_named:
        name = ""
    return f"{text} ({name}line {line})"


def frames_of(error: BaseException) -> list[tuple[str, int]]:
    """The files and lines of an error's traceback, in the process where it was raised."""
    remote_frames = getattr(error, "remote_frames", None)
    if remote_frames is not None:
        return list(remote_frames)
    frames = []
    for frame, line in traceback.walk_tb(error.__traceback__):
        frames.append((frame.f_code.co_filename, line))
    return frames


STANDARD_LIBRARY = Path(os.__file__).parent


def _is_library(file: str) -> bool:
    """Whether a file belongs to numpy_cae, NumPy, SciPy or the standard library."""
    path = Path(file)
    if not path.is_absolute():
        return True
    is_standard = STANDARD_LIBRARY in path.parents and "site-packages" not in path.parts
    return is_standard or not {"numpy", "scipy", "numpy_cae"}.isdisjoint(path.parts)
