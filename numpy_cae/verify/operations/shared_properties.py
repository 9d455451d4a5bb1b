"""The properties that every operation shares: its value, each gradient, dtype, purity, strides.

docs/verify.md lists what is not tested because the contract leaves it open.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from numpy_cae.verify.checks.adjoint import check_adjoint
from numpy_cae.verify.checks.call import call_of_array
from numpy_cae.verify.checks.gradients import wrong_gradients, wrong_slope_together
from numpy_cae.verify.checks.mismatch import DTYPE, Mismatch
from numpy_cae.verify.operations.case import LAYOUTS, ORDINARY, THE_SAME, Case
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.property import (
    EXACT,
    UPSTREAM,
    Finding,
    Findings,
    Property,
    agrees,
    compared,
    copied,
    copies,
    differentiated,
    drawn_upstream,
    property_of,
    results,
    right_results,
    rounding,
    unaltered,
)

FLOAT32 = float(np.finfo(np.float32).eps)
FLOAT32_ULPS = 64
"""FLOAT32_ULPS: a result of float32 may be off by so many roundings of float32."""
OWN_ULPS = 1024
"""OWN_ULPS: the same for an operation of one's own, whose terms may cancel."""
FURTHER_CALLS = 7
"""FURTHER_CALLS: in some cases a result is compared again after so many further calls."""
GRADIENT_POINTS = VALUE_POINTS = 2
VALUE = "the value is that of the definition, loop by loop"
LAYOUT = {"layout": tuple(LAYOUTS)}
ALIKE_IN_SIZE = {"values": (ORDINARY, "random", "ties", "large", "constant", "repeated slices")}
"""Classes whose entries are of similar size, so that rounding of large ones hides no small one."""


def shared_properties(operation: Operation) -> Iterator[Property]:
    """The properties that every operation has; some are stated for each argument."""
    if operation.reference or operation.definition:
        options = {"points": VALUE_POINTS, "is_form": False}
        yield property_of(operation, "value", VALUE, _value, {}, **options)
    for name in operation.differentiated:
        what = f"the gradient for {name}"
        right = "the definition" if operation.reference else "central differences"
        statement = f"the pullback's gradient for {name} is that of {right}"
        findings = partial(_gradient, name)
        options = {"points": GRADIENT_POINTS, "is_gradient": True, "subject": what}
        classes = UPSTREAM | operation.without_ties
        yield property_of(
            operation, f"gradient for {name}", statement, findings, classes, **options
        )
    if operation.seeded_by and not operation.reference:
        yield property_of(operation, "ties", TIES, _ties, UPSTREAM | TIED)
    for name in operation.linear_in:
        statement = f"<A {name}, dy> = <{name}, A' dy> to rounding, A' being the pullback"
        findings = partial(_adjoint, name)
        classes = UPSTREAM | ALIKE_IN_SIZE
        yield property_of(operation, f"adjoint in {name}", statement, findings, classes)
    for name, statement, findings, classes, options in SHARED:
        yield property_of(operation, name, statement, findings, classes, **options)
    if operation.reference:
        more = operation.longer
        longer = {size: (*given, *more.get(size, ())) for size, given in operation.sizes.items()}
        longer["upstream"] = (ORDINARY, "random", "integers", "sparse")
        every = {"combined": ("values", "of"), "together": TOGETHER}
        yield property_of(operation, LARGEST, SPECIAL, compared, longer, **every)


def _value(operation: Operation, implementation: Callable, case: Case) -> Findings:
    arguments = operation.arguments(case)
    value, _ = call_of_array(implementation, copies(arguments))
    right = operation.value(*copies(arguments))
    of_first = _again("the value", value, right)
    yield of_first._replace(tolerance=EXACT, floor=operation.floor)
    others = operation.arguments(Case(case.sizes, case.seed + 1))
    one = list(arguments)[case.seed // 2 % len(arguments)]
    kept, new = (arguments, others) if case.seed % 2 else (others, arguments)
    others = {**kept, one: new[one]}  # all but one are the same, or only one
    value, _ = implementation(*copies(others))
    which = "another" if case.seed % 2 else "the same"
    what = f"of {which} {one} after a first call, the value"
    yield Finding(what, value, operation.value(*copies(others)))


def _gradient(
    argument: str, operation: Operation, implementation: Callable, case: Case
) -> Findings:
    """Compare with the definition's gradient, or with differences if the value is wrong."""
    arguments = operation.arguments(case)
    names = operation.differentiated
    value, pullback = call_of_array(implementation, copies(arguments))
    what = f"the gradient for {argument}"
    right = {}
    if operation.reference:
        dy, right = right_results(operation, case, arguments)
    if right and agrees(value, right["the value"]):
        gradient = differentiated(operation, pullback(copied(dy)))[argument]
        both = (operation.alike(arguments, one) for one in (gradient, right[what]))
        yield Finding(what, *both, rounding(case, arguments), operation.floor_of(dy))
    elif not operation.reference or case.get("values") == case.get("state") == ORDINARY:
        f = _of_differentiated(operation, implementation, arguments)
        inputs = [arguments[name] for name in names]
        others = {"upstream": partial(drawn_upstream, case), "kinks_excused": 1.0}
        others["may_be_single"] = bool(operation.seeded_by)
        problems = wrong_gradients(f, inputs, names, case.rng(), only=(argument,), **others)
        implementation(*copies(arguments))  # the call that a report shows
        if problems:
            raise problems[0]


def _ties(operation: Operation, implementation: Callable, case: Case) -> Findings:
    """Compare the gradients together with the slope of moving equal entries by equal amounts.

    Along such a direction a maximum of equal entries has no kink, so that a gradient that is given
    to each of them is found.
    """
    arguments = operation.arguments(case)
    f = _of_differentiated(operation, implementation, arguments)
    inputs = [arguments[name] for name in operation.differentiated]
    upstream = partial(drawn_upstream, case)
    problem = wrong_slope_together(f, inputs, operation.differentiated, upstream)
    implementation(*copies(arguments))  # the call that a report shows
    if problem:
        raise problem
    yield from ()


def _of_differentiated(
    operation: Operation, implementation: Callable, arguments: Mapping[str, object]
) -> Callable:
    """An implementation as a function of the arguments that get gradients."""

    def f(*inputs):
        named = dict(zip(operation.differentiated, inputs, strict=True))
        value, pullback = call_of_array(implementation, copies({**arguments, **named}))
        return value, lambda dy: pullback(copied(dy))

    return f


def _adjoint(argument: str, operation: Operation, implementation: Callable, case: Case) -> Findings:
    arguments = operation.arguments(case)
    if "b" in arguments:
        arguments["b"] = np.zeros_like(arguments["b"])
    x = arguments[argument]
    at_zero = np.copy(implementation(*copies({**arguments, argument: np.zeros_like(x)}))[0])
    dy = drawn_upstream(case, at_zero)
    value, *gradients = results(operation, implementation, copies(arguments), dy).values()
    pulled = gradients[operation.differentiated.index(argument)]
    check_adjoint(lambda x: (value - at_zero, lambda dy: pulled), x, dy)
    yield Finding("A' dy", pulled, pulled)


def _linearity(operation: Operation, implementation: Callable, case: Case) -> Findings:
    """Give three upstream gradients in the same array, after the value was deleted."""
    value, pullback = implementation(*copies(operation.arguments(case)))
    one = drawn_upstream(case, value)
    del value
    other = np.flip(one).copy() if np.ndim(one) else 1 / 3
    dy = np.copy(one)
    pulled = []
    for upstream in (one, other, 2 * one - 3 * other):
        dy[...] = upstream
        gradients = differentiated(operation, pullback(dy if np.ndim(one) else copied(upstream)))
        pulled.append({name: np.copy(gradient) for name, gradient in gradients.items()})
    of_one, of_other, of_both = pulled
    for name, gradient in of_both.items():
        expected = 2 * of_one[name] - 3 * of_other[name]
        yield _again(f"of 2 dy - 3 dy' the gradient for {name}", gradient, expected)


def _dtype(operation: Operation, implementation: Callable, case: Case) -> Findings:
    """Compare float32 with float64; arguments changed by rounding give the error allowed."""
    if case.get("state") == "huge":  # rounding may turn a gate, and then all frames that follow
        return
    if case.get("layout") == "broadcast" and not operation.reference:
        return  # equal entries cancel in general functions, and leave nothing but rounding
    rng = np.random.default_rng(0)
    layout = _layout(operation, case)
    arguments = operation.arguments(case)
    arguments = dict(zip(arguments, copies(arguments, layout), strict=True))
    dy = drawn_upstream(case, implementation(*copies(arguments))[0])
    dy = layout(dy) if np.ndim(dy) else dy
    given = {name: _in_float32(argument) for name, argument in arguments.items()}
    dy = np.float32(dy) if np.ndim(dy) else dy

    def in_float64(rounding: float) -> dict:
        def widened(array: np.ndarray) -> np.ndarray:
            if array.dtype != np.float32:
                return array
            if any(array is given[name] for name in operation.drawn_by_caller):
                return array.astype(float)
            return array * (1.0 + rounding * rng.choice([-0.5, 0.5], array.shape))

        wide_dy = widened(dy) if np.ndim(dy) else dy
        return results(operation, implementation, copies(given, widened), wide_dy)

    exact, *moved = (in_float64(rounding) for rounding in (0.0, FLOAT32, FLOAT32))
    floor = _largest(dy, *given.values()) if operation.saturates else 1.0
    laid_out = layout(dy) if np.ndim(dy) else dy
    of_float32 = results(operation, implementation, copies(given, layout), laid_out)
    for what, result in of_float32.items():
        _require_dtype(what, exact[what], np.float64)
        _require_dtype(what, result, np.float32)
        expected = operation.alike(arguments, exact[what])
        if np.all(np.isfinite(expected)):
            by = max(float(np.max(np.abs(m[what] - exact[what]), initial=0.0)) for m in moved)
            ulps = OWN_ULPS if operation.seeded_by else FLOAT32_ULPS
            allowed = ulps * (FLOAT32 * max(floor, _largest(expected)) + by)
            off = operation.alike(arguments, np.float64(result)) - expected
            yield Finding(f"of float32, the error of {what}", off, np.zeros_like(off), allowed)


def _layout(operation: Operation, case: Case) -> Callable[[np.ndarray], np.ndarray]:
    """The memory layout of a case; none that alters numbers which the caller has drawn."""
    name = case.get("layout")
    return LAYOUTS["read-only" if operation.drawn_by_caller and name == "broadcast" else name]


def _in_float32(argument: object) -> object:
    """An argument rounded to float32; a number such as a bound stays a Python float."""
    if isinstance(argument, float):
        return float(np.float32(argument))
    return argument.astype(np.float32) if np.asarray(argument).dtype == np.float64 else argument


def _largest(*arrays) -> float:
    """max |first entry| times max |entry of the others|, both at least 1."""
    sizes = [max(1.0, float(np.max(np.abs(array), initial=0.0))) for array in arrays]
    return sizes[0] * max(sizes[1:], default=1.0)


def _require_dtype(what: str, result, dtype: type) -> None:
    actual = np.asarray(result).dtype
    if actual != dtype and type(result) is not float:  # a Python number has no dtype to lose
        raise Mismatch(DTYPE, what, f"given {np.dtype(dtype)}, {what} is {actual}")


def _purity(operation: Operation, implementation: Callable, case: Case) -> Findings:
    layout = _layout(operation, case)
    arguments = operation.arguments(case)
    given = copies(arguments, layout)
    before = copies(dict(zip(arguments, given, strict=True)))

    def arguments_after(call: str) -> Findings:
        for name, after, was in zip(arguments, given, before, strict=True):
            yield unaltered(f"{name}, which the {call} must not alter,", after, was)

    value, pullback = implementation(*given)
    dy = drawn_upstream(case, value)
    yield from arguments_after("call")
    for layout_of_dy in (layout, np.ndarray.copy):
        dy_given = layout_of_dy(dy) if np.ndim(dy) else copied(dy)
        dy_before = np.copy(dy_given)
        pullback(dy_given)
        what = "the upstream gradient, which the pullback must not alter,"
        yield unaltered(what, dy_given, dy_before)
        yield from arguments_after("pullback")


@dataclass(frozen=True)
class _Called:
    """A call of an operation: its value, its pullback and an upstream gradient."""

    operation: Operation
    value: np.ndarray | float
    pullback: Callable
    dy: np.ndarray | float

    @classmethod
    def of(
        cls, operation: Operation, implementation: Callable, case: Case, given: list
    ) -> "_Called":
        value, pullback = implementation(*given)
        return cls(operation, value, pullback, drawn_upstream(case, value))

    def gradients(self, dy: np.ndarray | float | None = None) -> dict[str, np.ndarray]:
        """What the pullback returns, by default for the call's own upstream gradient."""
        upstream = self.dy if dy is None else dy
        return differentiated(self.operation, self.pullback(copied(upstream)))


def _independence(operation: Operation, implementation: Callable, case: Case) -> Findings:
    """Alternate between two calls, overwrite results, then change the arguments in place.

    In some cases the results of the first call are kept over eight calls.
    """
    call = partial(_Called.of, operation, implementation)
    another = Case(case.sizes, case.seed + 1)
    others = operation.arguments(another)
    given = copies(operation.arguments(case), _layout(operation, case))
    alone = call(case, given)
    value = np.copy(alone.value)
    right = _copied_by_name(alone.gradients())
    first = call(case, given)
    second = call(another, copies(others))
    second_value = np.copy(second.value)
    gradients = first.gradients()
    for _ in range(0 if case.seed % 4 else FURTHER_CALLS):
        call(another, copies(others)).gradients(second.dy)
    second_right = _copied_by_name(second.gradients())
    first.gradients(second.dy)
    yield _again("after further calls, the value that was returned first", first.value, value)
    yield from _kept(gradients, right)
    yield from _called_again(first, right)
    yield from _called_again(second, second_right)
    if case.get("layout") not in ("read-only", "broadcast"):
        _change_in_place(implementation, given, others)
        again = results(operation, implementation, given, copied(second.dy))
        expected = [second_value, *second_right.values()]
        for (what, result), other in zip(again.items(), expected, strict=True):
            yield _again(f"of the same arrays with other numbers, {what}", result, other)
        if not operation.drawn_by_caller:
            yield _with_one_other_entry(operation, implementation, case, given)


def _copied_by_name(gradients: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {name: np.copy(gradient) for name, gradient in gradients.items()}


def _kept(gradients: Mapping[str, np.ndarray], right: Mapping[str, np.ndarray]) -> Findings:
    """Compare gradients with their copies; then overwrite them, as a caller may."""
    for name, gradient in gradients.items():
        what = f"after further calls, the gradient for {name} that was returned first"
        yield _again(what, gradient, right[name])
        if isinstance(gradient, np.ndarray) and gradient.flags.writeable:
            gradient[...] = np.nan


def _called_again(call: _Called, right: Mapping[str, np.ndarray]) -> Findings:
    for name, gradient in call.gradients().items():
        yield _again(f"called again, the gradient for {name}", gradient, right[name])


def _change_in_place(implementation: Callable, given: list, others: Mapping[str, object]) -> None:
    """Call with arguments, then give the same arrays other numbers."""
    implementation(*given)
    for number, new in enumerate(others.values()):
        if isinstance(new, np.ndarray):
            given[number][...] = new
        else:
            given[number] = new


def _with_one_other_entry(
    operation: Operation, implementation: Callable, case: Case, given: list
) -> Finding:
    """Change one entry in place between two calls, to what it is in the case itself."""
    arguments = operation.arguments(case)
    names = operation.differentiated
    name = names[case.seed % len(names)]
    array = given[list(arguments).index(name)]
    entry = case.seed // len(names) % array.size
    array.flat[entry] = arguments[name].flat[entry]
    value = np.copy(implementation(*given)[0])
    known = operation.reference or operation.definition
    right = operation.value if known else lambda *arrays: implementation(*arrays)[0]
    expected = right(*(np.copy(a) if isinstance(a, np.ndarray) else a for a in given))
    return _again(f"of the same arrays with one other entry of {name}, the value", value, expected)


def _strides(operation: Operation, implementation: Callable, case: Case) -> Findings:
    arguments = operation.arguments(case)
    layout = _layout(operation, case)
    given = copies(arguments, layout)
    for number, name in enumerate(arguments):
        if case.get("of") not in (ORDINARY, name):
            given[number] = arguments[name]
    arguments = dict(zip(arguments, given, strict=True))  # broadcasting makes entries equal
    dy = drawn_upstream(case, implementation(*copies(arguments))[0])
    laid_out = layout(dy) if np.ndim(dy) else dy
    plain = laid_out.copy() if np.ndim(dy) else dy
    expected = results(operation, implementation, copies(arguments), plain)
    expected = {what: np.copy(result) for what, result in expected.items()}
    for what, result in results(operation, implementation, given, laid_out).items():
        both = (operation.alike(arguments, one) for one in (result, expected[what]))
        yield _again(f"of arrays {case.get('layout')}, {what}", *both)


def _again(what: str, result, expected) -> Finding:
    """A comparison with an earlier result; entries that were not finite are left out."""
    result = np.asarray(result)
    if result.shape != np.shape(expected):
        return Finding(what, result, expected)
    finite = np.isfinite(expected)
    return Finding(what, np.where(finite, result, 0), np.where(finite, expected, 0))


LARGEST = "special inputs"
SPECIAL = "equal, sorted, zero, wide, large or long arrays too give what the definition gives"
KEPT = {"state": ORDINARY}
TOGETHER = ({}, KEPT | {"upstream": "sparse"}, KEPT | {"values": "huge", "of": "b"})
"""Classes tried with the project's sizes. Where a state is kept: one gradient far back, and gates
that pass the state over all frames."""
VIEWS = {"layout": tuple(LAYOUTS)[1:], "values": (ORDINARY, "random", "ties")}
TIED = {"values": ("ties", "signed zeros", "equal slices", "symmetric", "constant", THE_SAME)}
TIES = "along directions that keep equal entries equal, the gradients give the slope of the value"
LINEAR = "the pullback is linear: for 2 dy - 3 dy' it returns 2 and -3 times that of each"
LAID_OUT = "views in any memory order, or that cannot be written, give the same as copies"
PRECISE = "float32 stays float32, with its precision, float64 likewise"
PURE = "no argument and no upstream gradient is altered"
INDEPENDENT = "a pullback called again returns the same, whatever was called in between"
SHARED = (
    ("linearity", LINEAR, _linearity, UPSTREAM, {}),
    ("strides", LAID_OUT, _strides, UPSTREAM | VIEWS, {"combined": ("layout", "of")}),
    ("dtype", PRECISE, _dtype, UPSTREAM | LAYOUT, {}),
    ("purity", PURE, _purity, UPSTREAM | LAYOUT, {"watches_state": True}),
    ("independence", INDEPENDENT, _independence, UPSTREAM | LAYOUT, {}),
)
"""(name, statement, findings, classes, other fields of the property)."""
