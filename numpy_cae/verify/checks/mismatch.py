"""`Mismatch`: what a check raises where a result is not as expected, for people and programs."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from numpy_cae.verify.checks.leaves import is_float
from numpy_cae.verify.checks.messages import frames_of

NUMBER = "number"
SHAPE = "shape"
TYPE = "type"
COUNT = "count"
DTYPE = "dtype"
ALTERED = "altered"
NOT_FINITE = "not finite"
SLOPE = "slope"
KINK = "kink"
UNDECIDED = "undecided"
REPEATED = "repeated"
OVERWRITTEN = "overwritten"
"""The kinds of a mismatch."""

WIDENS_SCALARS = (np.float32(1.0) * 1.0).dtype != np.float32
"""Whether a scalar of float32 times a Python number is float64, as before NumPy 2."""


@dataclass(eq=False)
class Mismatch(AssertionError):
    """A result that is not as expected: `kind` is one of the kinds above.

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


def require_array(subject: str, result: Any) -> None:
    """Raise a Mismatch unless a result is an array; one of a subclass, such as a matrix, is not."""
    if result is None:
        raise Mismatch(TYPE, subject, f"{subject} is None: is a return missing?")
    if type(result) is not np.ndarray and not isinstance(result, np.generic):
        raise Mismatch(TYPE, subject, f"{subject} is a {type(result).__name__}, not an array")


def require_shape(subject: str, result: Any, shape: tuple[int, ...]) -> None:
    """Raise a Mismatch unless a result has this shape."""
    actual = np.shape(result)
    if actual != shape:
        raise Mismatch(SHAPE, subject, f"{subject} has shape {actual}, expected {shape}")


def require_finite(subject: str, result: Any) -> None:
    """Raise a Mismatch where a result of floats is nan or infinite."""
    if not is_float(result):
        return
    array = np.asarray(result)
    if np.all(np.isfinite(array)):
        return
    index = tuple(np.argwhere(~np.isfinite(array))[0].tolist())
    place = f" at index {index}" if index else ""
    text = f"{subject} is {array[index]}{place}: it has to be finite"
    raise Mismatch(NOT_FINITE, subject, text)


def kind_and_subject(error: BaseException) -> tuple[str, str]:
    """The kind and the subject of a mismatch; of another error its type (and line)."""
    if isinstance(error, Mismatch):
        return error.kind, error.subject
    place = ""
    if type(error).__name__ == "AssertionError":
        frames = frames_of(error)
        if frames:
            place = f"line {frames[-1][1]}"
    return type(error).__name__, place


def has_dtype(result: Any, dtype: Any) -> bool:
    """Whether a result has a dtype. A Python number has none to lose, nor has a scalar where NumPy
    widens scalars."""
    if type(result) is float or (WIDENS_SCALARS and np.ndim(result) == 0):
        return True
    return bool(np.asarray(result).dtype == dtype)
