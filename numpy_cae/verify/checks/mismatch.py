"""What a check raises: an error whose message is for people, and whose fields are for programs."""

import traceback
from dataclasses import dataclass

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
