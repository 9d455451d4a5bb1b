"""Properties of an operation of one's own that is given empty arrays, or arrays without axes."""

from collections.abc import Callable
from functools import partial

import numpy as np

from numpy_cae.verify.checks.calls import call_for_array
from numpy_cae.verify.checks.gradients import find_wrong_gradients
from numpy_cae.verify.operations.case import ORDINARY, Case
from numpy_cae.verify.operations.compare import Comparison, Pairs
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.property import REST, Property
from numpy_cae.verify.operations.results import copy_inputs
from numpy_cae.verify.operations.upstream import copy_upstream, draw_upstream

ANY_AXES = "..."
"""How any number of axes is written in a shape."""
FEW_EXAMPLES = 6
"""An empty array has no entries to draw, so few cases are tried."""
EMPTY = "where {} is 0, the value is finite and each gradient has the shape of its argument"
WITHOUT_AXES = "a number in place of an array has the gradients of central differences"


def state_empty_arrays(operation: Operation, size: str) -> Property:
    """The property that an operation takes arrays in which a size is 0, or without "..." axes."""
    if size == ANY_AXES:
        name = "without axes"
        statement = WITHOUT_AXES
        sizes = {**operation.sizes, "axes": (0,)}
    else:
        name = f"empty in {size}"
        statement = EMPTY.format(size)
        sizes = {**operation.sizes, size: (0,)}
    return Property(
        name,
        statement,
        Comparison(operation, _compare_with_differences),
        sizes={**sizes, "values": (ORDINARY,)},
        examples=FEW_EXAMPLES,
        operation=operation.name,
        arguments=operation.arguments,
        group=REST,
        seeded_by=operation.seeded_by,
    )


def _compare_with_differences(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Raise unless the value is finite and all gradients have their shapes and are right."""
    arguments = {}
    for name, argument in operation.arguments(case).items():
        # A number of NumPy becomes an array without axes.
        arguments[name] = np.array(argument) if isinstance(argument, np.generic) else argument
    names = operation.differentiated

    def f(*arrays: object) -> tuple:
        named = arguments | dict(zip(names, arrays, strict=True))
        value, pullback = call_for_array(implementation, copy_inputs(named))
        return value, lambda dy: pullback(copy_upstream(dy))

    arrays = [arguments[name] for name in names]
    upstream = partial(draw_upstream, case)
    problems = find_wrong_gradients(
        f, arrays, names, case.rng(), upstream=upstream, kinks_excused=1.0
    )
    if problems:
        raise problems[0]
    yield from ()
