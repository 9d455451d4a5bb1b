"""A property: a sentence about an operation, and the check that tests an implementation for it.

The properties that every operation shares are stated here; those of a single one are in
`operation_properties`. Each compares what an implementation returns with what it should return.

Not tested, as the contract leaves it open: which of several equal points of sliced Wasserstein gets
which gradient, the dtype of a gradient where dy has another dtype than the arguments, a list for a
tuple, views of the arguments as results, a loss as a Python float, warnings, empty arrays.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.call import call_of_array, gradients_of, require_array
from numpy_cae.verify.case import LAYOUTS, ORDINARY, Case, Sizes, spread
from numpy_cae.verify.gradients import check_gradients
from numpy_cae.verify.operation import Operation

EXACT = 1e-10
EXAMPLES = 25
"""The number of cases drawn, unless a property states another."""
FLOAT32 = float(np.finfo(np.float32).eps)
FLOAT32_ULPS = 64
GRADIENT_POINTS = VALUE_POINTS = 2
UPSTREAM = {"upstream": (ORDINARY, "zeros", "integers", "random", "sparse", "strided", "constant")}
LAYOUT = {"layout": tuple(LAYOUTS)}

Findings = Iterator[tuple]
"""Of each thing compared: what it is, as found, as expected, and the tolerance if not EXACT."""


@dataclass(frozen=True)
class Comparison:
    """The check of an operation's property: every finding is as expected."""

    operation: Operation
    findings: Callable[[Operation, Callable, Case], Findings]

    def __call__(self, implementation: Callable, case: Case) -> None:
        for finding in self.findings(self.operation, implementation, case):
            require_equal(*finding)

    def found(self, implementation: Callable, case: Case) -> list:
        """What an implementation does, without comparison; an error's words are the last."""
        seen: list = []
        try:
            with np.errstate(all="ignore"):
                for _, found, *_ in self.findings(self.operation, implementation, case):
                    seen.append(np.copy(found))
        except (Exception, SystemExit) as error:
            words = re.findall(r"[A-Za-z]\w+", str(error))
            seen.append(np.array([type(error).__name__, *words]))
        return seen


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

    @property
    def definition(self) -> Operation | None:
        """The operation, if its value and pullback have a definition to compare with."""
        operation = getattr(self.check, "operation", None)
        return operation if operation is not None and operation.reference else None


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


def property_of(
    operation: Operation,
    name: str,
    statement: str,
    findings: Callable[[Operation, Callable, Case], Findings],
    classes: Mapping[str, tuple] = UPSTREAM,
    points: int = 1,
) -> Property:
    """A property of an operation, tried with its sizes and further classes."""
    check, sizes = Comparison(operation, findings), {**operation.sizes, **classes}
    return Property(operation.name, name, statement, check, operation.arguments, sizes, points)


def shared_properties(operation: Operation) -> Iterator[Property]:
    """The properties that every operation has, those of its arguments one by one."""
    value = "the value is that of the definition, loop by loop"
    yield property_of(operation, "value", value, _value, {}, VALUE_POINTS)
    for name in operation.differentiated:
        statement = f"the pullback's gradient for {name} is that of central differences"
        check, points = _gradient_for(name), {"points": GRADIENT_POINTS}
        yield property_of(operation, f"gradient for {name}", statement, check, **points)
    for name in operation.linear_in:
        statement = f"<A {name}, dy> = <{name}, A' dy> to rounding, A' being the pullback"
        yield property_of(operation, f"adjoint in {name}", statement, _adjoint_in(name))
    for name, statement, findings, classes in SHARED:
        yield property_of(operation, name, statement, findings, classes)


def differentiated(operation: Operation, pulled) -> dict[str, np.ndarray]:
    """The gradients that a pullback returned, by argument."""
    gradients = gradients_of(pulled, len(operation.differentiated))
    named = dict(zip(operation.differentiated, gradients, strict=True))
    for name, gradient in named.items():
        require_array(name, gradient)
    return named


def drawn_upstream(case: Case, value: np.ndarray) -> np.ndarray | float:
    """An upstream gradient for a value, of the case's class; an ordinary one is never all ones."""
    rng, kind, shape = np.random.default_rng([case.seed, 1]), case.get("upstream"), np.shape(value)
    if not shape:
        special = {"zeros": 0, "sparse": 0.0, "integers": -3, "constant": 1, "random": 0.7}
        return special.get(kind, np.float64(rng.uniform(1.5, 2.5)))
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
        return LAYOUTS["every other entry"](dy)
    return np.broadcast_to(2.0, shape) if kind == "constant" else dy


def require_equal(
    what: str, found, expected, tolerance: float = EXACT, entrywise: bool = False
) -> None:
    """Raise unless two arrays agree in shape and, to rounding, in every entry.

    The tolerance is relative to the largest entry, or to each if `entrywise`.
    """
    found, expected = np.asarray(found), np.asarray(expected)
    if found.shape != expected.shape:
        raise AssertionError(f"{what} has shape {found.shape}, expected {expected.shape}")
    largest = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    allowed = tolerance * (np.abs(expected) if entrywise else largest)
    wrong = ~(np.abs(found - expected) <= allowed)
    if wrong.any():
        index = tuple(int(i) for i in np.argwhere(wrong)[0])
        place = f" at index {index}" if index else ""
        raise AssertionError(
            f"{what} is {found[index]:.10g}{place}, expected {expected[index]:.10g}"
        )


def agrees(found, expected) -> bool:
    """Whether `require_equal` holds."""
    try:
        require_equal("", found, expected)
    except AssertionError:
        return False
    return True


def copied(dy: np.ndarray | float) -> np.ndarray | float:
    """An upstream gradient that the pullback may spoil."""
    return dy.copy() if isinstance(dy, np.ndarray) and dy.flags.writeable else dy


def copies(arguments: dict[str, object]) -> list:
    return _laid_out(arguments, np.copy)


def _laid_out(arguments: dict[str, object], layout: Callable) -> list:
    return [layout(a) if isinstance(a, np.ndarray) else a for a in arguments.values()]


def _again(what: str, found, expected) -> tuple:
    """A result and the same result before; where that is not finite, only its shape counts."""
    found, finite = np.asarray(found), np.isfinite(expected)
    if found.shape == np.shape(expected):
        return what, np.where(finite, found, 0), np.where(finite, expected, 0)
    return what, found, expected


def _value(operation: Operation, implementation: Callable, case: Case) -> Findings:
    arguments = operation.arguments(case)
    value, _ = call_of_array(implementation, copies(arguments))
    if operation.reference is None:
        yield "the value", value, operation.definition(**arguments)
    else:
        expected, _ = operation.reference(*copies(arguments))
        yield "the value", value, expected, EXACT, operation.selects


def _gradient_for(argument: str) -> Callable:
    def findings(operation: Operation, implementation: Callable, case: Case) -> Findings:
        """Compare with the definition's; if the value is another, with that value's differences."""
        arguments, names = operation.arguments(case), operation.differentiated
        if operation.reference is not None:
            value, pullback = call_of_array(implementation, copies(arguments))
            expected, reference = operation.reference(*copies(arguments))
            if agrees(value, expected):
                dy = drawn_upstream(case, expected)
                both = (differentiated(operation, f(copied(dy))) for f in (pullback, reference))
                alike = (operation.alike(arguments, gradients[argument]) for gradients in both)
                yield f"the gradient for {argument}", *alike, EXACT, operation.selects
                return
        if not case.get("values") == case.get("state") == ORDINARY:
            return

        def f(*inputs):
            given = copies({**arguments, **dict(zip(names, inputs, strict=True))})
            value, pullback = call_of_array(implementation, given)
            return value, lambda dy: pullback(copied(dy))

        inputs = [arguments[name] for name in names]
        check_gradients(f, *inputs, rng=case.rng(), names=names, only=(argument,))

    return findings


def _adjoint_in(argument: str) -> Callable:
    def findings(operation: Operation, implementation: Callable, case: Case) -> Findings:
        arguments = operation.arguments(case)
        if "b" in arguments:
            arguments["b"] = np.zeros_like(arguments["b"])
        x = arguments[argument]
        at_zero, _ = implementation(*copies({**arguments, argument: np.zeros_like(x)}))
        pulled = []

        def linear_part(x):
            value, pullback = implementation(*copies({**arguments, argument: x}))

            def of_argument(dy):
                pulled.append(differentiated(operation, pullback(dy))[argument])
                return pulled[-1]

            return value - at_zero, of_argument

        check_adjoint(linear_part, x, drawn_upstream(case, at_zero))
        yield "A' dy", pulled[-1], pulled[-1]

    return findings


def _linearity(operation: Operation, implementation: Callable, case: Case) -> Findings:
    value, pullback = implementation(*copies(operation.arguments(case)))
    one = drawn_upstream(case, value)
    other = np.flip(one).copy() if np.ndim(one) else 1 / 3
    of_one, of_other, of_both = (
        {name: np.copy(g) for name, g in differentiated(operation, pullback(dy)).items()}
        for dy in (copied(one), copied(other), 2 * one - 3 * other)
    )
    for name, gradient in of_both.items():
        expected = 2 * of_one[name] - 3 * of_other[name]
        yield _again(f"of 2 dy - 3 dy' the gradient for {name}", gradient, expected)


def results(operation: Operation, implementation: Callable, arguments: list, dy) -> dict:
    """The value and the gradients of one call, by what they are."""
    value, pullback = implementation(*arguments)
    gradients = differentiated(operation, pullback(copied(dy)))
    return {"the value": value, **{f"the gradient for {n}": g for n, g in gradients.items()}}


def _dtype(operation: Operation, implementation: Callable, case: Case) -> Findings:
    """float32 is compared with float64; rounding the arguments tells how far it may be off."""
    rng, arguments = np.random.default_rng(0), operation.arguments(case)
    dy = drawn_upstream(case, implementation(*copies(arguments))[0])
    for what, result in results(operation, implementation, copies(arguments), dy).items():
        _require_dtype(what, result, np.float64)
    given = {name: _in_float32(argument) for name, argument in arguments.items()}
    dy = dy if type(dy) in (int, float) else np.float32(dy)

    def in_float64(rounding: float) -> dict:
        wide = [_widened(argument, rounding, rng) for argument in given.values()]
        return results(operation, implementation, wide, np.float64(dy))

    exact, *moved = (in_float64(rounding) for rounding in (0.0, FLOAT32, FLOAT32))
    floor = _largest(dy, *given.values()) if operation.saturates else 1.0
    for what, found in results(operation, implementation, copies(given), dy).items():
        _require_dtype(what, found, np.float32)
        expected = operation.alike(arguments, exact[what])
        if np.all(np.isfinite(expected)):
            by = max(float(np.max(np.abs(m[what] - exact[what]), initial=0.0)) for m in moved)
            allowed = FLOAT32_ULPS * (FLOAT32 * max(floor, _largest(expected)) + by)
            off = operation.alike(arguments, np.float64(found)) - expected
            yield f"of float32, the error of {what}", off, np.zeros_like(off), allowed


def _widened(argument: object, rounding: float, rng: np.random.Generator) -> object:
    """An array of float32 as float64, each entry rounded up or down."""
    if isinstance(argument, np.ndarray) and argument.dtype == np.float32:
        return argument * (1.0 + rounding * rng.choice([-0.5, 0.5], argument.shape))
    return argument


def _largest(*arrays) -> float:
    """The product of the largest size of the first and of the others, each at least 1."""
    sizes = [max(1.0, float(np.max(np.abs(array), initial=0.0))) for array in arrays]
    return sizes[0] * max(sizes[1:], default=1.0)


def _require_dtype(what: str, result, dtype: type) -> None:
    found = np.asarray(result).dtype
    if found != dtype and type(result) is not float:  # a Python number has no dtype to lose
        raise AssertionError(f"given {np.dtype(dtype)}, {what} is {found}")


def _in_float32(argument: object) -> object:
    """An argument rounded to float32; a number such as a bound stays a Python float."""
    if isinstance(argument, float):
        return float(np.float32(argument))
    return argument.astype(np.float32) if np.asarray(argument).dtype == np.float64 else argument


def _purity(operation: Operation, implementation: Callable, case: Case) -> Findings:
    layout, arguments = LAYOUTS[case.get("layout")], operation.arguments(case)
    given = _laid_out(arguments, layout)
    value, pullback = implementation(*given)
    dy = drawn_upstream(case, value)
    for name, before, after in zip(arguments, arguments.values(), given, strict=True):
        yield f"{name}, which the call must not alter,", 1 * after, 1 * before, 0
    for layout_of_dy in (layout, np.copy):
        dy_given = layout_of_dy(dy) if np.ndim(dy) else dy
        pullback(dy_given)
        yield "the upstream gradient, which the pullback must not alter,", dy_given, dy, 0
        for name, before, after in zip(arguments, arguments.values(), given, strict=True):
            yield f"{name}, which the pullback must not alter,", 1 * after, 1 * before, 0


def _independence(operation: Operation, implementation: Callable, case: Case) -> Findings:
    """Two calls with pullbacks in turn, results overwritten, then arguments changed in place."""
    arguments, another = operation.arguments(case), Case(case.sizes, case.seed + 1)
    given, others = _laid_out(arguments, LAYOUTS[case.get("layout")]), operation.arguments(another)
    returned, pullback = implementation(*given)
    value, dy = np.copy(returned), drawn_upstream(case, returned)

    def pulled(by: Callable, upstream) -> dict[str, np.ndarray]:
        return differentiated(operation, by(copied(upstream)))

    first = pulled(pullback, dy)
    before = {name: np.copy(gradient) for name, gradient in first.items()}
    other_value, other_pullback = implementation(*copies(others))
    other_value, other_dy = np.copy(other_value), drawn_upstream(another, other_value)
    other = {name: np.copy(gradient) for name, gradient in pulled(other_pullback, other_dy).items()}
    pulled(pullback, other_dy)
    yield _again("after further calls, the value that was returned first", returned, value)
    for name, gradient in first.items():
        what = f"after further calls, the gradient for {name} that was returned first"
        yield _again(what, gradient, before[name])
        if isinstance(gradient, np.ndarray) and gradient.flags.writeable:
            gradient[...] = np.nan
    for by, upstream, expected in ((pullback, dy, before), (other_pullback, other_dy, other)):
        for name, gradient in pulled(by, upstream).items():
            yield _again(f"called again, the gradient for {name}", gradient, expected[name])
    if case.get("layout") != "read-only":
        for number, new in enumerate(others.values()):
            if isinstance(new, np.ndarray):
                given[number][...] = new
            else:
                given[number] = new
        again = implementation(*given)[0]
        yield _again("of the same arrays with other numbers, the value", again, other_value)


def _strides(operation: Operation, implementation: Callable, case: Case) -> Findings:
    arguments, layout = operation.arguments(case), LAYOUTS[case.get("layout")]
    value, _ = implementation(*copies(arguments))
    dy = drawn_upstream(case, value)
    plain = np.array(dy) if np.ndim(dy) else dy
    expected = results(operation, implementation, copies(arguments), plain)
    expected = {what: np.copy(result) for what, result in expected.items()}
    value, pullback = implementation(*_laid_out(arguments, layout))
    gradients = differentiated(operation, pullback(layout(dy) if np.ndim(dy) else dy))
    for (what, before), found in zip(expected.items(), [value, *gradients.values()], strict=True):
        alike = (operation.alike(arguments, a) for a in (found, before))
        yield _again(f"of arrays {case.get('layout')}, {what}", *alike)


SHARED = (
    (
        "linearity",
        "the pullback is linear: for 2 dy - 3 dy' it returns 2 and -3 times that of each",
        _linearity,
        UPSTREAM,
    ),
    ("dtype", "float32 stays float32, with its precision, float64 likewise", _dtype, UPSTREAM),
    ("purity", "no argument and no upstream gradient is altered", _purity, UPSTREAM | LAYOUT),
    (
        "independence",
        "a pullback called again returns the same, whatever was called in between",
        _independence,
        UPSTREAM | LAYOUT,
    ),
    (
        "strides",
        "views in any memory order, or that cannot be written, give the same as copies",
        _strides,
        {**UPSTREAM, "layout": tuple(LAYOUTS)[1:]},
    ),
)
"""Name, statement, findings and classes of what does not depend on an operation's arguments."""
