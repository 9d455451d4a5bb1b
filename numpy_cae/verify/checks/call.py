"""One call of a function that returns a value and its pullback, and how it may be wrong.

Arguments may be lists, tuples and dicts of arrays: their parts are `leaves`. A `Mismatch` is what a
check raises, for people and for programs.
"""

import inspect
import os
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

CONTAINERS = (dict, list, tuple)
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


def call(f: Callable, inputs: Sequence) -> tuple[object, Callable]:
    """Call f; raise a TypeError unless it returns a value of floats, and a pullback."""
    returned = f(*inputs)
    if not is_pair(returned):
        expected = "expected a value and its pullback, a tuple of an array and a function"
        raise TypeError(f"{expected}, got {described(returned)}")
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


def leaves(name: str, argument: object) -> Iterator[tuple[str, object]]:
    """The parts of an argument by name, such as params['w'] and params['b'], or itself."""
    if not isinstance(argument, CONTAINERS):
        yield name, argument
        return
    for key in argument if isinstance(argument, dict) else range(len(argument)):
        yield from leaves(f"{name}[{key!r}]", argument[key])


def rebuilt(argument: object, parts: Iterator) -> object:
    """The argument with other parts, in the order of `leaves`."""
    if isinstance(argument, dict):
        return {key: rebuilt(part, parts) for key, part in argument.items()}
    if isinstance(argument, list | tuple):
        return type(argument)([rebuilt(part, parts) for part in argument])
    return next(parts)


def all_leaves(inputs: Sequence, names: Sequence[str]) -> list[tuple[str, object]]:
    """The parts of all arguments by name."""
    return [leaf for both in zip(names, inputs, strict=True) for leaf in leaves(*both)]


def gradients_of_leaves(inputs: Sequence, names: Sequence[str], pulled: object) -> list:
    """What a pullback returned for each part of the arguments; None where it returned nothing.

    It may return a gradient for each argument, or for those that have arrays of floats. Raise an
    Mismatch if there is another number of gradients, if one has not the structure of its
    argument, or if one belongs to something that has none, such as integers.
    """
    of_floats = [i for i, x in enumerate(inputs) if any(is_array(n, x) for n, x in leaves("", x))]
    if len(of_floats) == 1 and isinstance(inputs[of_floats[0]], list | tuple):
        nested = isinstance(pulled, list | tuple) and len(pulled) == 1
        pulled = pulled if nested and isinstance(pulled[0], CONTAINERS) else (pulled,)
    if isinstance(pulled, list | tuple) and len(pulled) == len(inputs):
        of_floats = range(len(inputs))
    given = dict(zip(of_floats, gradients_of(pulled, len(of_floats)), strict=True))
    matched = [g for i, x in enumerate(inputs) for g in _matched(names[i], x, given.get(i))]
    for (name, leaf), gradient in zip(all_leaves(inputs, names), matched, strict=True):
        if is_array(name, leaf) or (isinstance(leaf, float) and gradient is not None):
            _require_gradient(name, np.shape(leaf), gradient)
        elif gradient is not None:
            unexpected = f"{name} is {described(leaf)}, which is not differentiated"
            returned = f"{unexpected}, but the pullback returns a gradient for it"
            raise Mismatch(COUNT, "the pullback", returned)
    return matched


def is_array(name: str, leaf: object) -> bool:
    """Whether this is an array that gets a gradient; a TypeError if it is of complex numbers."""
    if not isinstance(leaf, np.ndarray) or not np.issubdtype(leaf.dtype, np.inexact):
        return False
    if leaf.dtype not in (np.float64, np.float32):
        raise TypeError(f"{name} must be an array of float64 or float32, not of {leaf.dtype}")
    return True


def _matched(name: str, argument: object, gradient: object) -> list:
    """The parts of a gradient that has the structure of its argument; None for each without one."""
    if not isinstance(argument, CONTAINERS):
        return [gradient]
    expected = dict(leaves(name, argument))
    given = dict(leaves(name, gradient))
    if gradient is not None and expected.keys() != given.keys():
        what = f"the gradient for {name}"
        structure = f"the structure of {name}, {described(argument)}"
        raise Mismatch(TYPE, what, f"{what} is {described(gradient)}, expected {structure}")
    return [given.get(part) for part in expected]


def _require_gradient(name: str, shape: tuple[int, ...], gradient: object) -> None:
    """Raise unless a gradient is an array of real numbers in the shape of its argument."""
    what = f"the gradient for {name}"
    if shape or not isinstance(gradient, float):
        require_array(what, gradient)
    require_shape(what, gradient, shape)
    if np.iscomplexobj(gradient):
        raise Mismatch(TYPE, what, f"{what} is complex")


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
    foreign = [one for one in frames if one.filename == file or not _is_library(one.filename)]
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
