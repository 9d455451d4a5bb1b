"""One call of a function that returns a value and its pullback, and what the pullback returns."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from numpy_cae.verify.checks.leaves import (
    CONTAINERS,
    all_leaves,
    has_gradient,
    is_float,
    leaves,
    outputs_of,
)
from numpy_cae.verify.checks.messages import describe
from numpy_cae.verify.checks.mismatch import COUNT, TYPE, Mismatch, require_array, require_shape


def call_operation(f: Callable, inputs: Sequence) -> tuple[Any, Callable]:
    """Call f; raise a TypeError unless it returns a value of floats, and a pullback."""
    returned = f(*inputs)
    if not is_value_and_pullback(returned):
        expected = "expected a value and its pullback, a tuple of an array and a function"
        raise TypeError(f"{expected}, got {describe(returned)}")
    outputs = outputs_of(returned[0])
    if not any(is_float(output) for output in outputs):
        raise TypeError(f"expected a value of floats, got {describe(returned[0])}")
    if any(np.iscomplexobj(output) for output in outputs):
        raise TypeError(
            "the value is complex: check `verify.of_complex(f)`, in which each complex number is a "
            "pair of real ones"
        )
    return returned


def is_value_and_pullback(returned: Any) -> bool:
    """Whether a call returned a value and a pullback."""
    return isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1])


def call_for_array(f: Callable, inputs: Sequence) -> tuple[np.ndarray, Callable]:
    """`call_operation`, for a value that is one array or number."""
    value, pullback = call_operation(f, inputs)
    if isinstance(value, tuple | list):
        raise TypeError(
            f"expected a value of floats, got {describe(value)}. Several outputs are checked by "
            "`verify.check_gradients`, or here when they are joined into one array"
        )
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


def gradients_of_leaves(inputs: Sequence, names: Sequence[str], pulled: object) -> list:
    """What a pullback returned for each part of the arguments; None where it returned nothing.

    It may return a gradient for each argument, or for those that have arrays of floats. Raise an
    Mismatch if there is another number of gradients, if one has not the structure of its
    argument, or if one belongs to something that has none, such as integers.
    """
    by_position = _gradients_by_position(inputs, pulled)
    gradients = []
    for position, (name, argument) in enumerate(zip(names, inputs, strict=True)):
        gradients += _match_structure(name, argument, by_position.get(position))
    for (name, leaf), gradient in zip(all_leaves(inputs, names), gradients, strict=True):
        _require_gradient_or_none(name, leaf, gradient)
    return gradients


def _gradients_by_position(inputs: Sequence, pulled: Any) -> dict[int, Any]:
    """The gradients that a pullback returned, by the positions of their arguments."""
    positions = []
    for position, argument in enumerate(inputs):
        if any(has_gradient(name, leaf) for name, leaf in leaves("", argument)):
            positions.append(position)
    if len(positions) == 1 and isinstance(inputs[positions[0]], list | tuple):
        # A bare list is the gradient itself, in the structure of its argument.
        is_wrapped = isinstance(pulled, list | tuple) and len(pulled) == 1
        if not (is_wrapped and isinstance(pulled[0], CONTAINERS)):
            pulled = (pulled,)
    if isinstance(pulled, list | tuple) and len(pulled) == len(inputs):
        positions = list(range(len(inputs)))
    return dict(zip(positions, gradients_of(pulled, len(positions)), strict=True))


def _match_structure(name: str, argument: object, gradient: object) -> list:
    """The parts of a gradient that has the structure of its argument; None for each without one."""
    if not isinstance(argument, CONTAINERS):
        return [gradient]
    expected = dict(leaves(name, argument))
    parts = dict(leaves(name, gradient))
    if gradient is not None and expected.keys() != parts.keys():
        subject = f"the gradient for {name}"
        structure = f"the structure of {name}, {describe(argument)}"
        text = f"{subject} is {describe(gradient)}, expected {structure}"
        raise Mismatch(TYPE, subject, text)
    return [parts.get(part) for part in expected]


def _require_gradient_or_none(name: str, leaf: Any, gradient: Any) -> None:
    """Raise unless an array has its gradient, and what is not differentiated has none."""
    if has_gradient(name, leaf) or (isinstance(leaf, float) and gradient is not None):
        _require_gradient(name, np.shape(leaf), gradient)
    elif gradient is not None:
        unexpected = f"{name} is {describe(leaf)}, which is not differentiated"
        text = f"{unexpected}, but the pullback returns a gradient for it"
        raise Mismatch(COUNT, "the pullback", text)


def _require_gradient(name: str, shape: tuple[int, ...], gradient: Any) -> None:
    """Raise unless a gradient is an array of real numbers in the shape of its argument."""
    subject = f"the gradient for {name}"
    if shape or not isinstance(gradient, float):
        require_array(subject, gradient)
    require_shape(subject, gradient, shape)
    if np.iscomplexobj(gradient):
        raise Mismatch(TYPE, subject, f"{subject} is complex")
