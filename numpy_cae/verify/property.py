"""A property: a sentence about an operation, and the check that tests an implementation for it.

The properties that every operation shares are stated here; those of a single one are in
`operation_properties`. A check takes an implementation and a case, and raises where the sentence
is false.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.gradients import as_gradients, check_gradients, value_and_pullback
from numpy_cae.verify.operation import Operation, Sizes

EXACT = 1e-9
EXAMPLES = 25
"""The number of cases drawn, unless a property states another."""
BEYOND_FLOAT32 = 1 + 2**-35  # times a short number, one that float32 cannot hold
GRADIENT_POINTS = VALUE_POINTS = 2


@dataclass(frozen=True)
class Property:
    """One sentence about one operation, that any implementation can be tested for."""

    operation: str
    name: str
    statement: str
    check: Callable[[Callable, Case], None] = field(repr=False)
    arguments: Callable[[Case], dict[str, object]] = field(repr=False)
    sizes: Sizes = field(repr=False)
    points: int = 1
    hint: str = ""
    examples: int = EXAMPLES


@dataclass(frozen=True)
class Outcome:
    """The result of one property: if it does not hold, why, where, and the likely mistake."""

    stated: Property
    held: bool
    problem: str = ""
    counterexample: str = ""
    mistake: str = ""

    @property
    def points(self) -> int:
        return self.stated.points if self.held else 0


def shared_properties(operation: Operation) -> Iterator[Property]:
    """The properties that every operation has, those of its arguments one by one."""

    def stated(name, statement, check, points=1) -> Property:
        check, arguments = partial(check, operation), operation.arguments
        return Property(operation.name, name, statement, check, arguments, operation.sizes, points)

    yield stated("value", "the value is that of the definition, loop by loop", _value, VALUE_POINTS)
    for argument in operation.differentiated:
        yield stated(
            f"gradient for {argument}",
            f"the pullback's gradient for {argument} is that of central differences",
            _gradient_for(argument),
            GRADIENT_POINTS,
        )
    for argument in operation.linear_in:
        yield stated(
            f"adjoint in {argument}",
            f"<A {argument}, dy> = <{argument}, A' dy> to rounding, A' being the pullback",
            _adjoint_in(argument),
        )
    yield stated(
        "linearity",
        "the pullback is linear: for 2 dy - 3 dy' it returns 2 and -3 times what it does for each",
        _linearity,
    )
    yield stated("dtype", "float32 stays float32, and float64 is float64 throughout", _dtype)
    yield stated("purity", "no argument and no upstream gradient is altered", _purity)
    yield stated(
        "independence",
        "a pullback called again returns the same, whatever was called in between",
        _independence,
    )
    yield stated("strides", "views in any memory order give the same as copies", _strides)


def differentiated(operation: Operation, pulled) -> dict[str, np.ndarray]:
    """The gradients that a pullback returned, by argument."""
    gradients = as_gradients(pulled, len(operation.differentiated))
    return dict(zip(operation.differentiated, gradients, strict=True))


def drawn_upstream(case: Case, value: np.ndarray) -> np.ndarray:
    """An upstream gradient for a value, drawn like the arguments and never all ones."""
    rng = np.random.default_rng([case.seed, 1])
    return spread(rng, np.shape(value)) if np.ndim(value) else np.float64(rng.uniform(1.5, 2.5))


def require_equal(what: str, found, expected, tolerance: float = EXACT) -> None:
    """Raise unless two arrays agree in shape and, to rounding, in every entry."""
    found, expected = np.asarray(found), np.asarray(expected)
    if found.shape != expected.shape:
        raise AssertionError(f"{what} has shape {found.shape}, expected {expected.shape}")
    allowed = tolerance * max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    wrong = ~(np.abs(found - expected) <= allowed)
    if wrong.any():
        index = tuple(int(i) for i in np.argwhere(wrong)[0])
        place = f" at index {index}" if index else ""
        raise AssertionError(
            f"{what} is {found[index]:.10g}{place}, expected {expected[index]:.10g}"
        )


def _value(operation: Operation, implementation: Callable, case: Case) -> None:
    arguments = operation.arguments(case)
    value, _ = value_and_pullback(implementation, _copies(arguments))
    require_equal("the value", value, operation.definition(**arguments))


def _gradient_for(argument: str) -> Callable:
    def check(operation: Operation, implementation: Callable, case: Case) -> None:
        arguments = operation.arguments(case)
        names = operation.differentiated

        def f(*inputs):
            given = _copies({**arguments, **dict(zip(names, inputs, strict=True))})
            value, pullback = value_and_pullback(implementation, given)
            return value, lambda dy: pullback(np.copy(dy) if np.ndim(dy) else dy)

        inputs = [arguments[name] for name in names]
        check_gradients(f, *inputs, rng=case.rng(), names=names, only=(argument,))

    return check


def _adjoint_in(argument: str) -> Callable:
    def check(operation: Operation, implementation: Callable, case: Case) -> None:
        arguments = operation.arguments(case)
        x = arguments[argument]
        at_zero, _ = implementation(*_copies({**arguments, argument: np.zeros_like(x)}))

        def linear_part(x):
            value, pullback = implementation(*_copies({**arguments, argument: x}))
            return value - at_zero, lambda dy: differentiated(operation, pullback(dy))[argument]

        check_adjoint(linear_part, x, drawn_upstream(case, at_zero))

    return check


def _linearity(operation: Operation, implementation: Callable, case: Case) -> None:
    value, pullback = implementation(*_copies(operation.arguments(case)))
    one = drawn_upstream(case, value)
    other = np.flip(one) if np.ndim(one) else one / 3
    of_one, of_other, of_both = (
        differentiated(operation, pullback(np.copy(dy) if np.ndim(dy) else dy))
        for dy in (one, other, 2 * one - 3 * other)
    )
    for name in operation.differentiated:
        expected = 2 * of_one[name] - 3 * of_other[name]
        require_equal(f"of 2 dy - 3 dy' the gradient for {name}", of_both[name], expected)


def _dtype(operation: Operation, implementation: Callable, case: Case) -> None:
    for dtype in (np.float32, np.float64):
        arguments = {
            name: (BEYOND_FLOAT32 * a).astype(dtype) if _is_float_array(a) else a
            for name, a in operation.arguments(case).items()
        }
        value, pullback = implementation(*arguments.values())
        dy = (BEYOND_FLOAT32 * drawn_upstream(case, value)).astype(dtype)
        results = {"the value": value}
        for name, gradient in differentiated(operation, pullback(dy)).items():
            results[f"the gradient for {name}"] = gradient
        for what, result in results.items():
            _require_dtype(what, result, np.dtype(dtype))


def _require_dtype(what: str, result, dtype: np.dtype) -> None:
    if type(result) is float:  # a loss as a Python number has no dtype to lose
        return
    found = np.asarray(result).dtype
    if found != dtype:
        raise AssertionError(f"given {dtype}, {what} is {found}")
    entries = np.asarray(result)
    fractions = entries[(entries % 0.0625 != 0) & (np.abs(entries) > 1e-3)]
    rounded = fractions.astype(np.float32).astype(dtype)
    if dtype == np.float64 and fractions.size and np.array_equal(fractions, rounded):
        raise AssertionError(f"given float64, {what} has only the precision of float32")


def _purity(operation: Operation, implementation: Callable, case: Case) -> None:
    arguments = operation.arguments(case)
    given = _copies(arguments)
    value, pullback = implementation(*given)
    dy = drawn_upstream(case, value)
    dy_given = np.copy(dy) if np.ndim(dy) else dy
    _require_same(arguments, given, "the call")
    pullback(dy_given)
    _require_same({**arguments, "the upstream gradient": dy}, [*given, dy_given], "the pullback")


def _require_same(arguments: dict[str, object], given: list, culprit: str) -> None:
    for (name, before), after in zip(arguments.items(), given, strict=True):
        if not np.array_equal(before, after):
            raise AssertionError(f"{culprit} alters {name}: an operation never does")


def _independence(operation: Operation, implementation: Callable, case: Case) -> None:
    value, pullback = implementation(*_copies(operation.arguments(case)))
    value, dy = np.copy(value), drawn_upstream(case, value)
    before = [np.copy(g) for g in as_gradients(pullback(dy), len(operation.differentiated))]
    other_value, other_pullback = implementation(
        *_copies(operation.arguments(Case(case.sizes, case.seed + 1)))
    )
    other_pullback(drawn_upstream(case, other_value))
    after = differentiated(operation, pullback(dy))
    for name, gradient in zip(operation.differentiated, before, strict=True):
        require_equal(f"called again, the gradient for {name}", after[name], gradient)


def _strides(operation: Operation, implementation: Callable, case: Case) -> None:
    arguments = operation.arguments(case)
    value, pullback = implementation(*_copies(arguments))
    dy = drawn_upstream(case, value)
    gradients = differentiated(operation, pullback(dy))
    for layout in (_fortran, _every_other, _reversed):
        views = [layout(a) if isinstance(a, np.ndarray) else a for a in arguments.values()]
        value_of_views, pullback = implementation(*views)
        require_equal(f"of {layout.__doc__}, the value", value_of_views, value)
        again = differentiated(operation, pullback(layout(dy) if np.ndim(dy) else dy))
        for name, gradient in gradients.items():
            require_equal(f"of {layout.__doc__}, the gradient for {name}", again[name], gradient)


def _fortran(array: np.ndarray) -> np.ndarray:
    """arrays in Fortran order"""
    return np.asfortranarray(array)


def _every_other(array: np.ndarray) -> np.ndarray:
    """every other entry of larger arrays"""
    larger = np.zeros((*array.shape[:-1], 2 * array.shape[-1]), dtype=array.dtype)
    larger[..., ::2] = array
    return larger[..., ::2]


def _reversed(array: np.ndarray) -> np.ndarray:
    """reversed views"""
    return array[::-1].copy()[::-1]


def _copies(arguments: dict[str, object]) -> list:
    return [a.copy() if isinstance(a, np.ndarray) else a for a in arguments.values()]


def _is_float_array(argument: object) -> bool:
    return isinstance(argument, np.ndarray) and argument.dtype == np.float64
