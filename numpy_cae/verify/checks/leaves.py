"""The arrays in the arguments and results of a function, which may be lists, tuples and dicts.

The parts of an argument are its `leaves`; a value that is a tuple or a list has several outputs.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

CONTAINERS = (dict, list, tuple)


def leaves(name: str, argument: object) -> Iterator[tuple[str, Any]]:
    """The parts of an argument by name, such as params['w'] and params['b'], or itself."""
    if isinstance(argument, dict):
        for key, part in argument.items():
            yield from leaves(f"{name}[{key!r}]", part)
    elif isinstance(argument, list | tuple):
        for index, part in enumerate(argument):
            yield from leaves(f"{name}[{index}]", part)
    else:
        yield name, argument


def all_leaves(inputs: Sequence, names: Sequence[str]) -> list[tuple[str, Any]]:
    """The parts of all arguments by name."""
    named: list[tuple[str, Any]] = []
    for name, argument in zip(names, inputs, strict=True):
        named += leaves(name, argument)
    return named


def rebuild(argument: Any, parts: Iterator) -> Any:
    """The argument with other parts, in the order of `leaves`."""
    if isinstance(argument, dict):
        return {key: rebuild(part, parts) for key, part in argument.items()}
    if isinstance(argument, list | tuple):
        return type(argument)([rebuild(part, parts) for part in argument])
    return next(parts)


def outputs_of(value: Any) -> Sequence:
    """The outputs of f: the entries of a tuple, or its one value."""
    return value if isinstance(value, tuple | list) else [value]


def flatten_floats(outputs: Sequence) -> np.ndarray:
    """All floats of some outputs, in one row."""
    return np.concatenate([np.ravel(output) for output in outputs if is_float(output)])


def is_float(thing: Any) -> bool:
    """Whether this is an array or a number of floats, real or complex."""
    return thing is not None and np.asarray(thing).dtype.kind in "fc"


def has_gradient(name: str, leaf: object) -> bool:
    """Whether this is an array that gets a gradient; a TypeError if it is of complex numbers."""
    if not isinstance(leaf, np.ndarray) or not np.issubdtype(leaf.dtype, np.inexact):
        return False
    if leaf.dtype not in (np.float64, np.float32):
        advice = ""
        if np.iscomplexobj(leaf):
            advice = ": `verify.of_complex(f)` takes pairs of real numbers in its place"
        raise TypeError(
            f"{name} must be an array of float64 or float32, not of {leaf.dtype}{advice}"
        )
    return True


def copy_arrays(things: Iterable) -> list:
    """The things in their order, the arrays among them copied."""
    return [np.copy(x) if isinstance(x, np.ndarray) else x for x in things]
