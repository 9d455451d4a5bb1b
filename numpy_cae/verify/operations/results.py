"""The value and the gradients that an implementation returns for a case, by name."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from numpy_cae.verify.checks.calls import gradients_of
from numpy_cae.verify.checks.mismatch import COUNT, TYPE, Mismatch, require_array
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.upstream import THE_UPSTREAM, copy_upstream, draw_upstream

THE_VALUE = "the value"

Inputs = dict[str, Any]
"""The arguments of a call by name, in their order; the upstream gradient may follow."""
Results = dict[str, Any]
"""The value and the gradients by name, such as "the gradient for x"."""


def results_of(operation: Operation, implementation: Callable, inputs: Iterable) -> Results:
    """The value and the gradients of one call; the upstream gradient is the last input."""
    *arguments, dy = inputs
    value, pullback = implementation(*arguments)
    return name_results(operation, value, pullback(dy))


def name_results(operation: Operation, value: Any, pulled: Any) -> Results:
    """A value and the gradients that its pullback returned, by name."""
    gradients = gradients_of(pulled, len(operation.differentiated))
    if len(gradients) == 1 and isinstance(pulled, tuple | list):
        text = "return the one gradient itself, not a tuple that contains it"
        raise Mismatch(COUNT, "the pullback", text)
    if isinstance(pulled, list):
        text = "the pullback returns a list, expected a tuple of gradients"
        raise Mismatch(TYPE, "the pullback", text)
    names = [f"the gradient for {name}" for name in operation.differentiated]
    results = {THE_VALUE: value, **dict(zip(names, gradients, strict=True))}
    for name in names:
        require_array(name, results[name])
    if not isinstance(value, float):
        require_array(THE_VALUE, value)
    return results


def right_results(operation: Operation, case: Case) -> tuple[Inputs, Results]:
    """The inputs of a case, and the definition's value and gradients."""
    if operation.reference is None:
        raise ValueError(f"{operation.name} has no definition with a pullback")
    inputs = operation.arguments(case)
    value, pullback = operation.reference(*copy_inputs(inputs))
    inputs[THE_UPSTREAM] = draw_upstream(case, value)
    pulled = pullback(copy_upstream(inputs[THE_UPSTREAM]))
    return inputs, name_results(operation, value, pulled)


def inputs_of(operation: Operation, implementation: Callable, case: Case) -> Inputs:
    """The arguments of a case, and an upstream gradient for the value that is returned."""
    arguments = operation.arguments(case)
    value, _ = implementation(*copy_inputs(arguments))
    return {**arguments, THE_UPSTREAM: draw_upstream(case, value)}


def copy_inputs(
    inputs: Mapping[str, Any], layout: Callable[[np.ndarray], np.ndarray] = np.ndarray.copy
) -> list:
    """The inputs in the order of the call, their arrays copied, in a memory layout.

    An array that occurs twice remains one array.
    """
    copies = {id(x): layout(x) for x in inputs.values() if isinstance(x, np.ndarray)}
    return [copies.get(id(x), x) for x in inputs.values()]
