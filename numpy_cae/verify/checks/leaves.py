"""The arrays in the arguments of a function: arguments may be lists, tuples and dicts of arrays."""

from collections.abc import Iterator, Sequence

import numpy as np

from numpy_cae.verify.checks.call import gradients_of, require_array, require_shape
from numpy_cae.verify.checks.mismatch import COUNT, TYPE, Mismatch
from numpy_cae.verify.checks.written import described

CONTAINERS = (dict, list, tuple)


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
