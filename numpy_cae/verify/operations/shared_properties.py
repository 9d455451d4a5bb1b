"""The properties that every operation shares: its value, each gradient, dtype, purity, strides.

docs/verify.md lists what is not tested because the contract leaves it open.
"""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from numpy_cae.verify.checks.call import DTYPE, OVERWRITTEN, Mismatch, call_of_array, require_shape
from numpy_cae.verify.checks.gradients import TOGETHER, check_adjoint, wrong_gradients
from numpy_cae.verify.operations import property as comparing
from numpy_cae.verify.operations.case import LAYOUTS, ORDINARY, THE_SAME, Case
from numpy_cae.verify.operations.operation import TABLE, Operation, sizes_of
from numpy_cae.verify.operations.property import UPSTREAM, Pair, Pairs, Property, copies

FLOAT32 = float(np.finfo(np.float32).eps)
FLOAT32_ULPS = 64
"""FLOAT32_ULPS: a result of float32 may be off by so many roundings of float32."""
OWN_ULPS = 1024
"""OWN_ULPS: the same for an operation of one's own, whose terms may cancel."""
DENSE = 33
"""DENSE: the largest size of "dtype" for operations of one's own: ordinary numbers are distinct and
so near to each other in larger arrays that a right layer may amplify the rounding of float32."""
FURTHER_CALLS = 7
"""FURTHER_CALLS: in some cases a result is compared again after so many further calls."""
POINTS = 2
"""POINTS: of the value and of each gradient; every other property has one point."""
VALUE = "the value is that of the definition, loop by loop"
LAYOUT = {"layout": tuple(LAYOUTS)}
WRITABLE = {"layout": tuple(LAYOUTS)[:-2]}
"""WRITABLE: the layouts in which a function can alter what it is given."""
ALIKE_IN_SIZE = {"values": (ORDINARY, "random", "ties", "large", "constant", "repeated slices")}
"""Classes whose entries are of similar size, so that rounding of large ones hides no small one."""


def shared_properties(operation: Operation) -> Iterator[Property]:
    """The properties that every operation has; some are stated for each argument."""
    stated = partial(comparing.property_of, operation)
    if operation.reference or operation.definition:
        yield stated("value", VALUE, _value, {}, points=POINTS, group=comparing.VALUE)
    for name in operation.differentiated:
        right = "the definition" if operation.has_right_gradients else "central differences"
        statement = f"the pullback's gradient for {name} is that of {right}"
        pairs = partial(_gradient, name)
        classes = UPSTREAM | operation.without_ties
        options = {"points": POINTS, "group": comparing.GRADIENT}
        yield stated(f"gradient for {name}", statement, pairs, classes, **options)
    if operation.seeded_by and not operation.reference:
        yield stated("ties", TIES, partial(_gradient, TOGETHER), UPSTREAM | TIED)
    for name in operation.linear_in:
        statement = f"<A {name}, dy> = <{name}, A' dy> to rounding, A' being the pullback"
        pairs = partial(_adjoint, name)
        yield stated(f"adjoint in {name}", statement, pairs, UPSTREAM | ALIKE_IN_SIZE)
    few = {"dtype": {s: o[: o.index(DENSE) + 1] for s, o in operation.sizes.items() if DENSE in o}}
    for name, statement, pairs, classes, options in SHARED:
        yield stated(name, statement, pairs, classes | few.get(name, {}), **options)
    if operation.has_right_gradients:
        more = operation.longer
        longer = {size: (*given, *more.get(size, ())) for size, given in operation.sizes.items()}
        longer["upstream"] = (ORDINARY, "random", "integers", "sparse")
        every = {"combined": ("values", "of"), "together": AT_FULL_SIZE}
        yield stated(LARGEST, SPECIAL, comparing.compared, longer, **every)


def own_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has: ties, bounds, limits, zeros.

    They are rows of the table `operations.toml`. Where one says what the definition returns for one
    class of values, it has no function of its own.
    """
    for row in TABLE["properties"]:
        if operation.name in row["operations"].split():
            pairs = OWN_CHECKS.get(row["name"], comparing.compared)
            classes = UPSTREAM | sizes_of(row.get("sizes", {}))
            yield comparing.property_of(operation, row["name"], row["statement"], pairs, classes)


def _value(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare the value, then that of a call with all but one argument, or only one, replaced."""
    arguments = operation.arguments(case)
    value, _ = call_of_array(implementation, copies(arguments))
    expected = operation.value(*copies(arguments))
    yield Pair("the value", value, expected, floor=operation.floor)
    others = operation.arguments(Case(case.sizes, case.seed + 1))
    one = list(arguments)[case.seed // 2 % len(arguments)]
    keeps_one = case.seed % 2 == 0
    others = {**others, one: arguments[one]} if keeps_one else {**arguments, one: others[one]}
    value, _ = implementation(*copies(others))
    what = f"of {'the same' if keeps_one else 'another'} {one} after a first call, the value"
    yield Pair(what, value, operation.value(*copies(others)))


def _gradient(argument: str, operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare with the definition's gradient, or with differences if the value is wrong."""
    arguments = operation.arguments(case)
    names = operation.differentiated
    value, _ = call_of_array(implementation, copies(arguments))
    what = f"the gradient for {argument}"
    right = {}
    if operation.reference:
        inputs, right = comparing.right_results(operation, case)
    has_right_value = right and comparing.agrees(value, right["the value"])
    if has_right_value and not operation.by_differences:
        gradient = comparing.results(operation, implementation, copies(inputs))[what]
        both = (operation.alike(inputs, one) for one in (gradient, right[what]))
        floor = operation.floor_of(inputs[comparing.THE_UPSTREAM])
        yield Pair(what, *both, comparing.rounding(case, inputs), floor)
    elif not operation.has_right_gradients or case.get("values") == case.get("state") == ORDINARY:

        def f(*inputs):
            named = arguments | dict(zip(names, inputs, strict=True))
            value, pullback = call_of_array(implementation, copies(named))
            return value, lambda dy: pullback(comparing.copied(dy))

        moved = [arguments[name] for name in names]
        options = {"upstream": partial(comparing.drawn_upstream, case), "kinks_excused": 1.0}
        problems = wrong_gradients(f, moved, names, case.rng(), only=(argument,), **options)
        implementation(*copies(arguments))  # the call that a report shows
        if problems and has_right_value:
            problems[0].result = comparing.results(operation, implementation, copies(inputs))[what]
            problems[0].expected = right[what]
        if problems:
            raise problems[0]


def _adjoint(argument: str, operation: Operation, implementation: Callable, case: Case) -> Pairs:
    inputs = comparing.inputs_of(operation, implementation, case)
    if "b" in inputs:
        inputs["b"] = np.zeros_like(inputs["b"])
    dy = inputs[comparing.THE_UPSTREAM]
    every = comparing.results(operation, implementation, copies(inputs))
    value = every["the value"]
    pulled = every[f"the gradient for {argument}"]
    if max(np.max(np.abs(value)), np.max(np.abs(pulled))) > comparing.EXACT:  # or its terms cancel
        check_adjoint(lambda x: (value, lambda dy: pulled), inputs[argument], dy)
    yield Pair("A' dy", pulled, pulled)


class _Called:
    """A call of an operation: its value, a copy of it, its pullback and an upstream gradient."""

    def __init__(self, operation: Operation, implementation: Callable, given: list) -> None:
        *arguments, self.dy = given
        self.operation = operation
        self.value, self.pullback = implementation(*arguments)
        self.right_value = np.copy(self.value)

    def results(self, dy: np.ndarray | float | None = None) -> dict[str, np.ndarray]:
        """The value and the gradients by name, by default for the call's own upstream gradient."""
        pulled = self.pullback(comparing.copied(self.dy if dy is None else dy))
        return comparing.by_name(self.operation, self.value, pulled)

    def kept(self, dy: np.ndarray | float | None = None) -> dict[str, np.ndarray]:
        """Copies of the results, the value as it was before the pullback was called."""
        copied = {what: np.copy(result) for what, result in self.results(dy).items()}
        return copied | {"the value": self.right_value}


def _linearity(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Give three upstream gradients in the same array, after the value was deleted."""
    *arguments, one = copies(comparing.inputs_of(operation, implementation, case))
    pullback = implementation(*arguments)[1]
    other = np.flip(one).copy() if np.ndim(one) else 1 / 3
    dy = np.copy(one)
    pulled = []
    for upstream in (one, other, 2 * one - 3 * other):
        dy[...] = upstream
        named = comparing.by_name(operation, 0.0, pullback(dy if np.ndim(one) else upstream))
        pulled.append({what: np.copy(gradient) for what, gradient in named.items()})
    of_one, of_other, of_both = pulled
    for what, gradient in of_both.items():
        expected = 2 * of_one[what] - 3 * of_other[what]
        terms = max(1.0, _largest(one) / _largest(expected))  # large terms may cancel in a sum
        tolerance = comparing.EXACT * terms
        yield Pair(f"of 2 dy - 3 dy' {what}", gradient, expected, tolerance)


def _dtype(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare float32 with float64; arguments changed by rounding give the error allowed."""
    is_broadcast = case.get("layout") == "broadcast"  # equal entries cancel in general functions
    turns = case.get("state") == "huge" or case.get("values") == "near ties"
    if turns or (is_broadcast and not operation.has_right_gradients):
        return  # rounding may turn a gate, and all frames that follow, or the order of two entries
    layout = _layout(operation, case)
    inputs = comparing.inputs_of(operation, implementation, case)
    given = dict(zip(inputs, map(_in_float32, copies(inputs, layout)), strict=True))
    exact, *moved = _in_float64(operation, implementation, given)
    *arguments, dy = given.values()
    floor = _largest(dy, *arguments) if operation.saturates else 1.0
    of_float32 = comparing.results(operation, implementation, copies(given, layout))
    for what, result in of_float32.items():
        _require_dtype(what, exact[what], np.float64)
        _require_dtype(what, result, np.float32)
        expected = operation.alike(given, exact[what])
        if np.all(np.isfinite(expected)):
            by = max(float(np.max(np.abs(m[what] - exact[what]), initial=0.0)) for m in moved)
            ulps = OWN_ULPS if operation.seeded_by else FLOAT32_ULPS
            allowed = ulps * (FLOAT32 * max(floor, _largest(expected)) + by)
            off = operation.alike(given, np.asarray(result, np.float64)) - expected
            yield Pair(f"of float32, the error of {what}", off, np.zeros_like(off), allowed)


def _in_float64(operation: Operation, implementation: Callable, given: dict) -> Iterator[dict]:
    """The results for float32 as float64: as they are, and twice changed by half a rounding."""
    rng = np.random.default_rng(0)
    as_drawn = [given[name] for name in operation.drawn_by_caller]

    def widened(rounding: float, array: np.ndarray) -> np.ndarray:
        if array.dtype != np.float32:
            return array
        if any(array is each for each in as_drawn):
            return array.astype(float)
        return array * (1.0 + rounding * rng.choice([-0.5, 0.5], array.shape))

    for rounding in (0.0, FLOAT32, FLOAT32):
        wide = copies(given, partial(widened, rounding))
        yield comparing.results(operation, implementation, wide)


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


def _purity(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    inputs = comparing.inputs_of(operation, implementation, case)
    given = copies(inputs, _layout(operation, case))
    called = _Called(operation, implementation, given)
    yield from comparing.unaltered(given, inputs, "call")
    for dy in (called.dy, comparing.copied(called.dy)):
        called.pullback(dy)
        yield from comparing.unaltered([*given[:-1], dy], inputs, "pullback")


def _independence(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Alternate between two calls, overwrite results, then change the arguments in place.

    In some cases the results of the first call are kept over eight calls.
    """
    call = partial(_Called, operation, implementation)
    another = Case(case.sizes, case.seed + 1)
    others = comparing.inputs_of(operation, implementation, another)
    inputs = comparing.inputs_of(operation, implementation, case)
    layout = _layout(operation, case)
    given = copies(inputs, layout)
    right = call(given).kept()
    first = call(copies(inputs, layout))
    second = call(copies(others, layout))
    returned = first.results()
    for _ in range(0 if case.seed % 4 else FURTHER_CALLS):
        call(copies(others)).results()
    second_right = second.kept()
    first.results(second.dy)
    for what, result in returned.items():
        place = f"after further calls, {what} that was returned first"
        yield Pair(place, result, right[what], kind=OVERWRITTEN)
        if result is not first.value and isinstance(result, np.ndarray) and result.flags.writeable:
            result[...] = np.nan  # as a caller may
    for called, expected in ((first, right), (second, second_right)):
        for what, result in called.results().items():
            yield Pair(f"called again, {what}", result, expected[what])
    implementation(*given[:-1])
    given = [_filled(*both) for both in zip(given, others.values(), strict=True)]
    for what, result in comparing.results(operation, implementation, given).items():
        place = f"of the same arrays with other numbers, {what}"
        yield Pair(place, result, second_right[what])
    if not operation.drawn_by_caller:
        yield _with_one_other_entry(operation, implementation, case, given[:-1])


def _filled(given: object, new: object) -> object:
    """The same array with other numbers, or another number."""
    if isinstance(new, np.ndarray):
        given[...] = new
        return given
    return new


def _with_one_other_entry(
    operation: Operation, implementation: Callable, case: Case, given: list
) -> Pair:
    """Change one entry in place between two calls, to what it is in the case itself."""
    arguments = operation.arguments(case)
    names = operation.differentiated
    name = names[case.seed % len(names)]
    array = given[list(arguments).index(name)]
    entry = case.seed // len(names) % array.size
    array.flat[entry] = arguments[name].flat[entry]
    known = operation.reference or operation.definition
    right = operation.value if known else lambda *arrays: np.copy(implementation(*arrays)[0])
    expected = right(*copies(dict(enumerate(given))))
    value = implementation(*given)[0]
    return Pair(f"of the same arrays with one other entry of {name}, the value", value, expected)


def _strides(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    inputs = comparing.inputs_of(operation, implementation, case)
    layout = _layout(operation, case)
    laid_out = zip(inputs, copies(inputs, layout), strict=True)
    chosen = [*inputs] if case.get("of") == ORDINARY else [case.get("of"), comparing.THE_UPSTREAM]
    given = inputs | {name: array for name, array in laid_out if name in chosen}
    expected = _Called(operation, implementation, copies(given)).kept()
    for what, result in comparing.results(operation, implementation, [*given.values()]).items():
        both = (operation.alike(given, one) for one in (result, expected[what]))
        yield Pair(f"of arrays {case.get('layout')}, {what}", *both)


LARGEST = "special inputs"
SPECIAL = "equal, sorted, zero, wide, large or long arrays too give what the definition gives"
KEPT = {"state": ORDINARY}
AT_FULL_SIZE = ({}, KEPT | {"upstream": "sparse"}, KEPT | {"values": "huge", "of": "b"})
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
    ("purity", PURE, _purity, UPSTREAM | WRITABLE, {}),
    ("independence", INDEPENDENT, _independence, UPSTREAM | WRITABLE, {}),
)
"""(name, statement, pairs, classes, other fields of the property)."""


def _exact_zeros(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """What is 0 by the definition has to be 0, without rounding."""
    inputs, right = comparing.right_results(operation, case)
    for what, result in comparing.results(operation, implementation, copies(inputs)).items():
        require_shape(what, result, np.shape(right[what]))
        yield Pair(what, np.where(right[what] == 0, result, 0), np.zeros_like(right[what]), 0)


def _one_by_default(operation: Operation, loss: Callable, case: Case) -> Pairs:
    for dtype in (np.float64, np.float32):
        arrays = [array.astype(dtype) for array in operation.arguments(case).values()]
        _, pullback = loss(*arrays)
        by_default = pullback()
        yield Pair("by default the gradient", by_default, pullback(1.0), 0)
        _require_dtype("by default the gradient", by_default, pullback(1.0).dtype)


OWN_CHECKS = {"zero at the target": _exact_zeros, "empty slot": _exact_zeros}
OWN_CHECKS["upstream default"] = _one_by_default
"""OWN_CHECKS: what is compared for the properties of these names; for others the definition's."""
