"""One call of a function that returns a value and its pullback, and what both return."""

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.verify.checks.mismatch import COUNT, NOT_FINITE, SHAPE, TYPE, Mismatch
from numpy_cae.verify.checks.written import described


def call(f: Callable, inputs: Sequence) -> tuple[object, Callable]:
    """Call f; raise a TypeError unless it returns a value of floats, and a pullback."""
    returned = f(*inputs)
    if not is_pair(returned):
        raise TypeError(
            "expected a value and its pullback, a tuple of an array and a function, "
            f"got {described(returned)}"
        )
    if not any(map(is_float, parts(returned[0]))):
        raise TypeError(f"expected a value of floats, got {described(returned[0])}")
    if any(np.iscomplexobj(part) for part in parts(returned[0])):
        raise TypeError("the value is complex: return its real and imaginary part as two outputs")
    return returned


def is_pair(returned: object) -> bool:
    """Whether a call returned a value and a pullback."""
    return isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1])


def call_of_array(f: Callable, inputs: Sequence) -> tuple[np.ndarray, Callable]:
    """`call`, for a value that is one array or number."""
    value, pullback = call(f, inputs)
    if isinstance(value, tuple | list):
        raise TypeError(f"expected a value of floats, got {described(value)}")
    return np.asarray(value), pullback


def gradients_of(pulled: object, count: int) -> tuple:
    """What a pullback returned as a tuple; raise a Mismatch if it has another length."""
    if pulled is None:
        raise Mismatch(TYPE, "the pullback", "the pullback returns None: is a return missing?")
    gradients = pulled if isinstance(pulled, tuple | list) else (pulled,)
    if len(gradients) != count:
        returned = f"the pullback returns {len(gradients)} gradient(s), expected {count}"
        order = "one for each differentiated argument, in their order"
        raise Mismatch(COUNT, "the pullback", f"{returned}: {order}")
    return tuple(gradients)


def require_array(what: str, result: object) -> None:
    """Raise a Mismatch unless a result is an array; one of a subclass, such as a matrix, is not."""
    if result is None:
        raise Mismatch(TYPE, what, f"{what} is None: is a return missing?")
    if type(result) is not np.ndarray and not isinstance(result, np.generic):
        raise Mismatch(TYPE, what, f"{what} is a {type(result).__name__}, not an array")


def require_shape(what: str, result: object, shape: tuple[int, ...]) -> None:
    """Raise a Mismatch unless a result has this shape."""
    if np.shape(result) != shape:
        raise Mismatch(SHAPE, what, f"{what} has shape {np.shape(result)}, expected {shape}")


def require_finite(what: str, result: object) -> None:
    """Raise a Mismatch where a result of floats is nan or infinite."""
    if is_float(result) and not np.all(np.isfinite(result)):
        index = tuple(np.argwhere(~np.isfinite(result))[0].tolist())
        place = f" at index {index}" if index else ""
        text = f"{what} is {np.asarray(result)[index]}{place}: it has to be finite"
        raise Mismatch(NOT_FINITE, what, text)


def parts(value: object) -> Sequence:
    """The outputs of f: the entries of a tuple, or its one value."""
    return value if isinstance(value, tuple | list) else [value]


def flat(outputs: Sequence) -> np.ndarray:
    """All floats of some outputs, in one row."""
    return np.concatenate([np.ravel(part) for part in outputs if is_float(part)])


def is_float(thing: object) -> bool:
    return thing is not None and np.issubdtype(np.asarray(thing).dtype, np.inexact)


def copies(things: Sequence) -> list:
    """The arrays among some things copied."""
    return [np.copy(x) if isinstance(x, np.ndarray) else x for x in things]
