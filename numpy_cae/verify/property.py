"""A property: a sentence about an operation, and the check that tests an implementation for it.

The properties that every operation shares are stated here; those of a single one are in
`operation_properties`. A check takes an implementation and a case, and raises where the sentence
is false.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.case import ORDINARY, Case, Sizes, spread
from numpy_cae.verify.gradients import as_gradients, check_gradients, value_and_pullback
from numpy_cae.verify.layout import LAYOUTS
from numpy_cae.verify.operation import Operation

EXACT = 1e-10
EXAMPLES = 25
"""The number of cases drawn, unless a property states another."""
BEYOND_FLOAT32 = 1 + 2**-35  # times a short number, one that float32 cannot hold
FLOAT32 = float(np.finfo(np.float32).eps)
GRADIENT_POINTS = VALUE_POINTS = 2
UPSTREAM = {"upstream": (ORDINARY, "zeros", "integers", "random", "sparse", "strided", "constant")}
LAYOUT = {"layout": tuple(LAYOUTS)}


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
    of: Operation | None = field(default=None, repr=False)


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

    def stated(name, statement, check, points=1, classes: Mapping = UPSTREAM) -> Property:
        check, sizes = partial(check, operation), {**operation.sizes, **classes}
        return Property(
            operation.name,
            name,
            statement,
            check,
            operation.arguments,
            sizes,
            points,
            of=operation,
        )

    value = "the value is that of the definition, loop by loop"
    yield stated("value", value, _value, VALUE_POINTS, {})
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
    linear = (
        "the pullback is linear: for 2 dy - 3 dy' it returns 2 and -3 times what it does for each"
    )
    yield stated("linearity", linear, _linearity)
    dtype = "float32 stays float32, with its precision, and float64 is float64 throughout"
    yield stated("dtype", dtype, _dtype)
    pure = "no argument and no upstream gradient is altered"
    yield stated("purity", pure, _purity, classes=UPSTREAM | LAYOUT)
    independent = "a pullback called again returns the same, whatever was called in between"
    yield stated("independence", independent, _independence, classes=UPSTREAM | LAYOUT)
    strided = "views in any memory order, or that cannot be written, give the same as copies"
    yield stated("strides", strided, _strides, classes={**UPSTREAM, "layout": tuple(LAYOUTS)[1:]})


def differentiated(operation: Operation, pulled) -> dict[str, np.ndarray]:
    """The gradients that a pullback returned, by argument."""
    gradients = as_gradients(pulled, len(operation.differentiated))
    named = dict(zip(operation.differentiated, gradients, strict=True))
    for name, gradient in named.items():
        if gradient is None:
            raise AssertionError(f"the gradient for {name} is None, expected shape that of {name}")
        if not isinstance(gradient, np.ndarray | np.generic):
            kind = type(gradient).__name__
            raise AssertionError(f"the gradient for {name} is a {kind}, not an array")
    return named


def drawn_upstream(case: Case, value: np.ndarray) -> np.ndarray | float:
    """An upstream gradient for a value, of the case's class; an ordinary one is never all ones."""
    rng, kind, shape = np.random.default_rng([case.seed, 1]), case.get("upstream"), np.shape(value)
    if not shape:
        number = rng.uniform(1.5, 2.5)
        special = {
            "zeros": 0,
            "integers": -3,
            "random": float(number),
            "sparse": 0.0,
            "constant": 1,
        }
        return special.get(kind, np.float64(number))
    dy = spread(rng, shape)
    if kind == "zeros":
        return np.zeros(shape)
    if kind == "integers":
        return rng.choice([-3.0, 1.0, 2.0], shape)
    if kind == "random":
        return rng.uniform(-8, 8, shape)
    if kind == "sparse":
        return np.where(np.arange(dy.size).reshape(shape) == rng.integers(dy.size), dy, 0.0)
    if kind == "strided":
        return LAYOUTS["every other"](dy)
    return np.broadcast_to(2.0, shape) if kind == "constant" else dy


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


def _require_repeated(what: str, found, expected) -> None:
    """Raise unless a result is the earlier one again; if that was nan, nan is."""
    missing = np.isnan(expected)
    if np.shape(found) == np.shape(expected) and np.array_equal(np.isnan(found), missing):
        found, expected = np.where(missing, 0, found), np.where(missing, 0, expected)
    finite = np.isfinite(expected)
    require_equal(what, np.where(finite, found, 0), np.where(finite, expected, 0))


def copied(dy: np.ndarray | float) -> np.ndarray | float:
    """An upstream gradient that the pullback may spoil."""
    return dy.copy() if isinstance(dy, np.ndarray) and dy.flags.writeable else dy


def agrees(found, expected) -> bool:
    """Whether `require_equal` holds."""
    try:
        require_equal("", found, expected)
    except AssertionError:
        return False
    return True


def _value(operation: Operation, implementation: Callable, case: Case) -> None:
    arguments = operation.arguments(case)
    value, _ = value_and_pullback(implementation, copies(arguments))
    if operation.reference is None:
        expected = operation.definition(**arguments)
    else:
        expected, _ = operation.reference(*copies(arguments))
    require_equal("the value", value, expected)


def _gradient_for(argument: str) -> Callable:
    def check(operation: Operation, implementation: Callable, case: Case) -> None:
        """Compare with the definition's; if the value is another, with that value's differences."""
        arguments = operation.arguments(case)
        if operation.reference is not None:
            value, pullback = value_and_pullback(implementation, copies(arguments))
            expected_value, reference = operation.reference(*copies(arguments))
            if agrees(value, expected_value):
                dy = drawn_upstream(case, expected_value)
                expected = differentiated(operation, reference(copied(dy)))[argument]
                found = differentiated(operation, pullback(copied(dy)))[argument]
                found, expected = (operation.alike(arguments, g) for g in (found, expected))
                require_equal(f"the gradient for {argument}", found, expected)
                return
        if case.get("values") == case.get("state") == ORDINARY:
            _agrees_with_differences(operation, implementation, arguments, argument, case)

    return check


def _agrees_with_differences(operation, implementation, arguments, argument, case) -> None:
    names = operation.differentiated

    def f(*inputs):
        given = copies({**arguments, **dict(zip(names, inputs, strict=True))})
        value, pullback = value_and_pullback(implementation, given)
        return value, lambda dy: pullback(copied(dy))

    inputs = [arguments[name] for name in names]
    check_gradients(f, *inputs, rng=case.rng(), names=names, only=(argument,))


def _adjoint_in(argument: str) -> Callable:
    def check(operation: Operation, implementation: Callable, case: Case) -> None:
        arguments = operation.arguments(case)
        if "b" in arguments:
            arguments["b"] = np.zeros_like(arguments["b"])
        x = arguments[argument]
        at_zero, _ = implementation(*copies({**arguments, argument: np.zeros_like(x)}))

        def linear_part(x):
            value, pullback = implementation(*copies({**arguments, argument: x}))
            return value - at_zero, lambda dy: differentiated(operation, pullback(dy))[argument]

        check_adjoint(linear_part, x, drawn_upstream(case, at_zero))

    return check


def _linearity(operation: Operation, implementation: Callable, case: Case) -> None:
    value, pullback = implementation(*copies(operation.arguments(case)))
    one = drawn_upstream(case, value)
    other = np.flip(one).copy() if np.ndim(one) else 1 / 3
    of_one, of_other, of_both = (
        {name: np.copy(g) for name, g in differentiated(operation, pullback(dy)).items()}
        for dy in (copied(one), copied(other), 2 * one - 3 * other)
    )
    for name in operation.differentiated:
        expected = 2 * of_one[name] - 3 * of_other[name]
        _require_repeated(f"of 2 dy - 3 dy' the gradient for {name}", of_both[name], expected)


def _dtype(operation: Operation, implementation: Callable, case: Case) -> None:
    wide = {
        name: BEYOND_FLOAT32 * a if _is_float_array(a) else a
        for name, a in operation.arguments(case).items()
    }
    value, pullback = implementation(*copies(wide))
    dy = drawn_upstream(case, value)
    long = BEYOND_FLOAT32 * (dy if np.ndim(dy) else float(dy))
    for what, result in _results(operation, value, pullback(long)).items():
        _require_dtype(what, result, np.dtype(np.float64))

    narrow = {name: in_float32(a) for name, a in wide.items()}
    short = dy if type(dy) in (int, float) else np.float32(dy)
    value, pullback = implementation(*copies(narrow))
    found = _results(operation, value, pullback(copied(short)))
    for what, result in found.items():
        _require_dtype(what, result, np.dtype(np.float32))
    allowed = _rounding(operation, implementation, narrow, short)
    for what, expected in _in_float64(operation, implementation, narrow, short).items():
        if np.all(np.isfinite(expected)) and np.shape(found[what]) == np.shape(expected):
            off = np.abs(operation.alike(narrow, np.float64(found[what])) - expected)
            if not np.max(off, initial=0) <= allowed[what]:
                raise AssertionError(
                    f"of float32, {what} is off by {np.max(off):.3g} from that of float64, "
                    f"where rounding explains {allowed[what]:.1g}"
                )


def _results(operation: Operation, value, pulled) -> dict[str, object]:
    """The value and the gradients of one call, by what they are."""
    gradients = differentiated(operation, pulled)
    return {"the value": value, **{f"the gradient for {n}": g for n, g in gradients.items()}}


def _in_float64(operation: Operation, function: Callable, narrow: dict, short, shift=0.0) -> dict:
    """The results for float32 numbers computed in float64; `shift` rounds each differently."""
    rng = np.random.default_rng(0)

    def widened(a):
        if not (isinstance(a, np.ndarray) and a.dtype == np.float32):
            return a
        return a * (1.0 + shift * rng.choice([-0.5, 0.5], a.shape))

    value, pullback = function(*(widened(a) for a in narrow.values()))
    results = _results(operation, value, pullback(widened(short)))
    return {what: operation.alike(narrow, np.float64(result)) for what, result in results.items()}


def _rounding(operation: Operation, function: Callable, narrow: dict, short) -> dict[str, float]:
    """By result, how far rounding may put a right computation in float32 off."""
    exact = _in_float64(operation, function, narrow, short)
    shifted = [_in_float64(operation, function, narrow, short, s) for s in (FLOAT32, -FLOAT32)]
    arrays = [a for a in narrow.values() if _is_float_array(a, np.float32)]
    size = max(float(np.max(np.abs(a), initial=1.0)) for a in arrays)
    floor = size * max(1.0, float(np.max(np.abs(short)))) if operation.saturates else 1.0
    allowed = {}
    for what, result in exact.items():
        scale = max(floor, float(np.max(np.abs(result), initial=0.0)))
        moved = max(float(np.max(np.abs(s[what] - result), initial=0.0)) for s in shifted)
        allowed[what] = 64 * FLOAT32 * scale + 32 * moved
    return allowed


def _require_dtype(what: str, result, dtype: np.dtype) -> None:
    if type(result) is float:  # a loss as a Python number has no dtype to lose
        return
    found = np.asarray(result).dtype
    if found != dtype:
        raise AssertionError(f"given {dtype}, {what} is {found}")
    entries = np.asarray(result)
    fractions = entries[(entries % 0.0625 != 0) & (np.abs(entries) > 1e-3)]
    with np.errstate(over="ignore"):
        rounded = fractions.astype(np.float32).astype(dtype)
    if dtype == np.float64 and fractions.size and np.array_equal(fractions, rounded):
        raise AssertionError(f"given float64, {what} has only the precision of float32")


def _purity(operation: Operation, implementation: Callable, case: Case) -> None:
    layout = LAYOUTS[case.get("layout")]
    arguments = operation.arguments(case)
    given = [layout(a) if isinstance(a, np.ndarray) else a for a in arguments.values()]
    value, pullback = implementation(*given)
    dy = drawn_upstream(case, value)
    _require_same(arguments, given, "the call")
    value = np.copy(value)
    for layout_of_dy in (layout, np.copy):
        dy_given = layout_of_dy(dy) if np.ndim(dy) else dy
        pullback(dy_given)
        upstream = {**arguments, "the upstream gradient": dy}
        _require_same(upstream, [*given, dy_given], "the pullback")


def _require_same(arguments: dict[str, object], given: list, culprit: str) -> None:
    for (name, before), after in zip(arguments.items(), given, strict=True):
        if not np.array_equal(before, after):
            raise AssertionError(f"{culprit} alters {name}: an operation never does")


def _independence(operation: Operation, implementation: Callable, case: Case) -> None:
    layout = LAYOUTS[case.get("layout")]
    arguments, another = operation.arguments(case), Case(case.sizes, case.seed + 1)
    given = [layout(a) if isinstance(a, np.ndarray) else a for a in arguments.values()]
    returned, pullback = implementation(*given)
    value, dy = np.copy(returned), drawn_upstream(case, returned)

    def pulled(by: Callable, upstream) -> dict[str, np.ndarray]:
        return differentiated(operation, by(copied(upstream)))

    first = pulled(pullback, dy)
    before = {name: np.copy(gradient) for name, gradient in first.items()}
    others = operation.arguments(another)
    other_value, other_pullback = implementation(*copies(others))
    other_value, other_dy = np.copy(other_value), drawn_upstream(another, other_value)
    other = {name: np.copy(gradient) for name, gradient in pulled(other_pullback, other_dy).items()}
    pulled(pullback, other_dy)
    _require_repeated("after further calls, the value that was returned first", returned, value)
    for name, gradient in first.items():
        what = f"after further calls, the gradient for {name} that was returned first"
        _require_repeated(what, gradient, before[name])
        if isinstance(gradient, np.ndarray) and gradient.flags.writeable:
            gradient[...] = np.nan
    for by, upstream, expected in ((pullback, dy, before), (other_pullback, other_dy, other)):
        for name, gradient in pulled(by, upstream).items():
            _require_repeated(f"called again, the gradient for {name}", gradient, expected[name])
    if case.get("layout") != "read-only":
        for array, new in zip(given, others.values(), strict=True):
            if isinstance(array, np.ndarray):
                array[...] = new
        again = [
            a if isinstance(a, np.ndarray) else b
            for a, b in zip(given, others.values(), strict=True)
        ]
        again, _ = implementation(*again)
        _require_repeated("of the same arrays with other numbers, the value", again, other_value)


def _strides(operation: Operation, implementation: Callable, case: Case) -> None:
    arguments, name = operation.arguments(case), case.get("layout")
    layout = LAYOUTS[name]
    value, pullback = implementation(*copies(arguments))
    dy = drawn_upstream(case, value)
    value, dy = np.copy(value), np.array(dy) if np.ndim(dy) else dy
    gradients = differentiated(operation, pullback(copied(dy)))
    views = [layout(a) if isinstance(a, np.ndarray) else a for a in arguments.values()]
    value_of_views, pullback = implementation(*views)
    _require_repeated(f"of {layout.__doc__}, the value", value_of_views, value)
    again = differentiated(operation, pullback(layout(dy) if np.ndim(dy) else dy))
    for name, gradient in gradients.items():
        found, expected = (operation.alike(arguments, g) for g in (again[name], gradient))
        _require_repeated(f"of {layout.__doc__}, the gradient for {name}", found, expected)


def in_float32(argument: object) -> object:
    """An argument rounded to float32; a number such as a bound stays a Python float."""
    if isinstance(argument, float):
        return float(np.float32(argument))
    return argument.astype(np.float32) if _is_float_array(argument) else argument


def copies(arguments: dict[str, object]) -> list:
    return [a.copy() if isinstance(a, np.ndarray) else a for a in arguments.values()]


def _is_float_array(argument: object, dtype: type = np.float64) -> bool:
    return isinstance(argument, np.ndarray) and argument.dtype == dtype
