"""Numbers, arrays and other things as they are written in a message."""

import traceback

import numpy as np

LONGEST_TEXT = 2000

WORTH_PRINTING = 32
"""Arrays of at most so many entries are printed in a counterexample."""


def written(value: object, digits: int = 6) -> str:
    """An argument or result as it is printed in a counterexample."""
    if not isinstance(value, np.ndarray):
        return f"{value:.{digits}g}" if isinstance(value, float) else repr(value)
    if value.dtype.kind == "f":
        value = np.array([f"{v:.{digits}g}" for v in value.flat], float).reshape(value.shape)
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
    kind = type(thing).__name__
    return f"a {kind} of {len(thing)}" if isinstance(thing, tuple | list | dict) else kind


def error_text(error: BaseException, file: str = "") -> str:
    """Type, message and line of an exception, even if its __str__ raises."""
    try:
        text = f"{type(error).__name__}: {error}"[: LONGEST_TEXT // 2]
    except Exception:
        text = f"{type(error).__name__}, whose message cannot be printed"
    if isinstance(error, SystemExit):
        text = "it calls sys.exit"
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    return f"{text} (line {lines[-1]})" if lines else text
