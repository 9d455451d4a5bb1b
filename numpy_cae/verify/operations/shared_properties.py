"""The properties that every operation shares: its value, each gradient, dtype, purity, strides.

docs/verify.md lists what is not tested because the contract leaves it open.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial

import numpy as np

from numpy_cae.verify.checks.call import call_of_array
from numpy_cae.verify.checks.gradients import TOGETHER, check_adjoint, wrong_gradients
from numpy_cae.verify.checks.mismatch import DTYPE, NUMBER, OVERWRITTEN, Mismatch
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
    of_first = _again("the value", value, operation.value(*copies(arguments)))
    yield of_first._replace(tolerance=comparing.EXACT, floor=operation.floor)
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
    value, pullback = call_of_array(implementation, copies(arguments))
    what = f"the gradient for {argument}"
    right = {}
    if operation.reference:
        dy, right = comparing.right_results(operation, case, arguments)
    has_right_value = right and comparing.agrees(value, right["the value"])
    if has_right_value and not operation.by_differences:
        gradient = comparing.differentiated(operation, pullback(comparing.copied(dy)))[argument]
        both = (operation.alike(arguments, one) for one in (gradient, right[what]))
        yield Pair(what, *both, comparing.rounding(case, arguments), operation.floor_of(dy))
    elif not operation.has_right_gradients or case.get("values") == case.get("state") == ORDINARY:

        def f(*inputs):
            named = arguments | dict(zip(names, inputs, strict=True))
            value, pullback = call_of_array(implementation, copies(named))
            return value, lambda dy: pullback(comparing.copied(dy))

        inputs = [arguments[name] for name in names]
        options = {"upstream": partial(comparing.drawn_upstream, case), "kinks_excused": 1.0}
        problems = wrong_gradients(f, inputs, names, case.rng(), only=(argument,), **options)
        _, pullback = implementation(*copies(arguments))  # the call that a report shows
        if problems and has_right_value:
            pulled = comparing.differentiated(operation, pullback(comparing.copied(dy)))
            problems[0].result = pulled[argument]
            problems[0].expected = right[what]
        if problems:
            raise problems[0]


def _adjoint(argument: str, operation: Operation, implementation: Callable, case: Case) -> Pairs:
    arguments = operation.arguments(case)
    if "b" in arguments:
        arguments["b"] = np.zeros_like(arguments["b"])
    x = arguments[argument]
    at_zero = np.copy(implementation(*copies({**arguments, argument: np.zeros_like(x)}))[0])
    dy = comparing.drawn_upstream(case, at_zero)
    given = copies(arguments)
    every = comparing.results(operation, implementation, given, comparing.copied(dy))
    pulled = every[f"the gradient for {argument}"]
    value = every["the value"] - at_zero
    if max(np.max(np.abs(value)), np.max(np.abs(pulled))) > comparing.EXACT:  # or its terms cancel
        check_adjoint(lambda x: (value, lambda dy: pulled), x, dy)
    yield Pair("A' dy", pulled, pulled)


class _Called:
    """A call of an operation: its value, a copy of it, its pullback and an upstream gradient."""

    def __init__(
        self, operation: Operation, implementation: Callable, case: Case, given: list
    ) -> None:
        self.operation = operation
        self.value, self.pullback = implementation(*given)
        self.right_value = np.copy(self.value)
        self.dy = comparing.drawn_upstream(case, self.value)

    def gradients(self, dy: np.ndarray | float | None = None) -> dict[str, np.ndarray]:
        """What the pullback returns, by default for the call's own upstream gradient."""
        upstream = comparing.copied(self.dy if dy is None else dy)
        return comparing.differentiated(self.operation, self.pullback(upstream))

    def kept(self, dy: np.ndarray | float | None = None) -> dict[str, np.ndarray]:
        """Copies of the gradients."""
        return {name: np.copy(gradient) for name, gradient in self.gradients(dy).items()}


def _linearity(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Give three upstream gradients in the same array, after the value was deleted."""
    called = _Called(operation, implementation, case, copies(operation.arguments(case)))
    del called.value
    one = called.dy
    other = np.flip(one).copy() if np.ndim(one) else 1 / 3
    dy = np.copy(one)
    pulled = []
    for upstream in (one, other, 2 * one - 3 * other):
        dy[...] = upstream
        gradients = called.pullback(dy if np.ndim(one) else upstream)
        named = comparing.differentiated(operation, gradients)
        pulled.append({name: np.copy(gradient) for name, gradient in named.items()})
    of_one, of_other, of_both = pulled
    for name, gradient in of_both.items():
        expected = 2 * of_one[name] - 3 * of_other[name]
        pair = _again(f"of 2 dy - 3 dy' the gradient for {name}", gradient, expected)
        terms = max(1.0, _largest(one) / _largest(expected))  # large terms may cancel in a sum
        yield pair._replace(tolerance=comparing.EXACT * terms)


def _dtype(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare float32 with float64; arguments changed by rounding give the error allowed."""
    is_broadcast = case.get("layout") == "broadcast"  # equal entries cancel in general functions
    turns = case.get("state") == "huge" or case.get("values") == "near ties"
    if turns or (is_broadcast and not operation.has_right_gradients):
        return  # rounding may turn a gate, and all frames that follow, or the order of two entries
    layout = _layout(operation, case)
    arguments = operation.arguments(case)
    arguments = dict(zip(arguments, copies(arguments, layout), strict=True))
    dy = comparing.drawn_upstream(case, implementation(*copies(arguments))[0])
    dy = _in_float32(layout(dy)) if np.ndim(dy) else dy
    given = {name: _in_float32(argument) for name, argument in arguments.items()}
    exact, *moved = _in_float64(operation, implementation, given, dy)
    floor = _largest(dy, *given.values()) if operation.saturates else 1.0
    dy = layout(dy) if np.ndim(dy) else dy
    of_float32 = comparing.results(operation, implementation, copies(given, layout), dy)
    for what, result in of_float32.items():
        _require_dtype(what, exact[what], np.float64)
        _require_dtype(what, result, np.float32)
        expected = operation.alike(arguments, exact[what])
        if np.all(np.isfinite(expected)):
            by = max(float(np.max(np.abs(m[what] - exact[what]), initial=0.0)) for m in moved)
            ulps = OWN_ULPS if operation.seeded_by else FLOAT32_ULPS
            allowed = ulps * (FLOAT32 * max(floor, _largest(expected)) + by)
            off = operation.alike(arguments, np.asarray(result, np.float64)) - expected
            yield Pair(f"of float32, the error of {what}", off, np.zeros_like(off), allowed)


def _in_float64(
    operation: Operation, implementation: Callable, given: Mapping[str, object], dy
) -> Iterator[dict]:
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
        wide = partial(widened, rounding)
        wide_dy = wide(dy) if np.ndim(dy) else dy
        yield comparing.results(operation, implementation, copies(given, wide), wide_dy)


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
    layout = _layout(operation, case)
    arguments = operation.arguments(case)
    given = copies(arguments, layout)
    called = _Called(operation, implementation, case, given)
    yield from comparing.unaltered(given, arguments, "call")
    for layout_of_dy in (layout, np.ndarray.copy):
        dy = layout_of_dy(called.dy) if np.ndim(called.dy) else called.dy
        before = {"the upstream gradient": np.copy(dy)}
        called.pullback(dy)
        yield from comparing.unaltered([dy], before, "pullback")
        yield from comparing.unaltered(given, arguments, "pullback")


def _independence(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Alternate between two calls, overwrite results, then change the arguments in place.

    In some cases the results of the first call are kept over eight calls.
    """
    call = partial(_Called, operation, implementation)
    another = Case(case.sizes, case.seed + 1)
    others = operation.arguments(another)
    arguments = operation.arguments(case)
    layout = _layout(operation, case)
    given = copies(arguments, layout)
    alone = call(case, given)
    right = alone.kept()
    first = call(case, copies(arguments, layout))
    second = call(another, copies(others, layout))
    gradients = first.gradients()
    for _ in range(0 if case.seed % 4 else FURTHER_CALLS):
        call(another, copies(others)).gradients(second.dy)
    second_right = second.kept()
    first.gradients(second.dy)
    what = "after further calls, the value that was returned first"
    yield _again(what, first.value, alone.right_value, OVERWRITTEN)
    yield from _kept(gradients, right)
    for called, expected in ((first, right), (second, second_right)):
        for name, gradient in called.gradients().items():
            yield _again(f"called again, the gradient for {name}", gradient, expected[name])
    implementation(*given)
    given = [_filled(*both) for both in zip(given, others.values(), strict=True)]
    again = comparing.results(operation, implementation, given, comparing.copied(second.dy))
    expected = [second.right_value, *second_right.values()]
    for (what, result), other in zip(again.items(), expected, strict=True):
        yield _again(f"of the same arrays with other numbers, {what}", result, other)
    if not operation.drawn_by_caller:
        yield _with_one_other_entry(operation, implementation, case, given)


def _kept(gradients: Mapping[str, np.ndarray], right: Mapping[str, np.ndarray]) -> Pairs:
    """Compare gradients with their copies; then overwrite them, as a caller may."""
    for name, gradient in gradients.items():
        what = f"after further calls, the gradient for {name} that was returned first"
        yield _again(what, gradient, right[name], OVERWRITTEN)
        if isinstance(gradient, np.ndarray) and gradient.flags.writeable:
            gradient[...] = np.nan


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
    return _again(f"of the same arrays with one other entry of {name}, the value", value, expected)


def _strides(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    arguments = operation.arguments(case)
    layout = _layout(operation, case)
    given = copies(arguments, layout)
    for number, name in enumerate(arguments):
        if case.get("of") not in (ORDINARY, name):
            given[number] = arguments[name]
    arguments = dict(zip(arguments, given, strict=True))  # broadcasting makes entries equal
    plain = _Called(operation, implementation, case, copies(arguments))
    laid_out = layout(plain.dy) if np.ndim(plain.dy) else plain.dy
    expected = {"the value": plain.right_value}
    expected |= {f"the gradient for {n}": g for n, g in plain.kept(laid_out).items()}
    for what, result in comparing.results(operation, implementation, given, laid_out).items():
        both = (operation.alike(arguments, one) for one in (result, expected[what]))
        yield _again(f"of arrays {case.get('layout')}, {what}", *both)


def _again(what: str, result, expected, kind: str = NUMBER) -> Pair:
    """A comparison with an earlier result; entries that were not finite are left out."""
    result = np.asarray(result)
    if result.shape == np.shape(expected):
        finite = np.isfinite(expected)
        result = np.where(finite, result, 0)
        expected = np.where(finite, expected, 0)
    return Pair(what, result, expected, kind=kind)


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


def _zero_at_the_target(operation: Operation, mean_squared_error: Callable, case: Case) -> Pairs:
    x = operation.arguments(case)["x"]
    loss, pullback = mean_squared_error(x.copy(), x)
    yield Pair("at the target the loss", loss, 0.0, 0)
    dloss = comparing.drawn_upstream(case, loss)
    yield Pair("at the target the gradient", pullback(dloss), np.zeros_like(x), 0)


def _one_by_default(operation: Operation, loss: Callable, case: Case) -> Pairs:
    for dtype in (np.float64, np.float32):
        arrays = [array.astype(dtype) for array in operation.arguments(case).values()]
        _, pullback = loss(*arrays)
        by_default = pullback()
        of_one = pullback(1.0)
        yield Pair("by default the gradient", by_default, of_one, 0)
        what = "by default the gradient's bytes a number"
        yield Pair(what, by_default.itemsize, of_one.itemsize, 0)


def _empty_slot(operation: Operation, unpool_random: Callable, case: Case) -> Pairs:
    y, first = operation.arguments(case).values()
    x, _ = unpool_random(y, first)
    yield Pair("the other frame", np.where(first, x[:, 1::2], x[:, 0::2]), np.zeros_like(y), 0)


OWN_CHECKS = {"zero at the target": _zero_at_the_target, "upstream default": _one_by_default}
OWN_CHECKS["empty slot"] = _empty_slot
"""OWN_CHECKS: what is compared for the properties of these names; for others the definition's."""
