"""The properties that every operation shares: its value, each gradient, dtype, purity, strides.

docs/what_is_tried.md lists what is not tested because the contract leaves it open.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from numpy_cae.verify.checks.calls import call_for_array
from numpy_cae.verify.checks.checked_function import TOGETHER
from numpy_cae.verify.checks.gradients import check_adjoint, find_wrong_gradients
from numpy_cae.verify.checks.mismatch import (
    DTYPE,
    OVERWRITTEN,
    Mismatch,
    has_dtype,
    require_finite,
    require_shape,
)
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.compare import (
    EXACT,
    Comparison,
    Pair,
    Pairs,
    agrees,
    canonical_pair,
    compare_with_copies,
    compare_with_definition,
    rounding_of,
)
from numpy_cae.verify.operations.operation import TABLE, Operation, sizes_of
from numpy_cae.verify.operations.property import GRADIENT, REST, VALUE, Property
from numpy_cae.verify.operations.results import (
    THE_VALUE,
    Inputs,
    Results,
    copy_inputs,
    inputs_of,
    name_results,
    results_of,
    right_results,
)
from numpy_cae.verify.operations.upstream import (
    THE_UPSTREAM,
    UPSTREAM,
    Upstream,
    copy_upstream,
    draw_upstream,
)
from numpy_cae.verify.operations.values import LAYOUTS, ORDINARY, THE_SAME

MakePairs = Callable[[Operation, Callable, Case], Pairs]
"""(operation, implementation, case) -> pairs to be compared."""


def shared_properties(operation: Operation) -> Iterator[Property]:
    """The properties that every operation has; some are stated for each argument."""
    if operation.has_right_value:
        value = state_property(operation, "value", VALUE_STATEMENT, _compare_value, {})
        yield replace(value, points=POINTS, group=VALUE)
    for name in operation.differentiated:
        yield _state_gradient(operation, name)
    if operation.is_own and operation.reference is None:
        compare_ties = partial(_compare_gradient, TOGETHER)
        yield state_property(operation, "ties", TIES, compare_ties, UPSTREAM | TIED)
    for name in operation.linear_in:
        statement = f"<A {name}, dy> = <{name}, A' dy> to rounding, A' being the pullback"
        compare_products = partial(_compare_inner_products, name)
        classes = UPSTREAM | SIMILAR_SIZES
        yield state_property(operation, f"adjoint in {name}", statement, compare_products, classes)
    yield state_property(operation, "linearity", LINEAR, _compare_multiples, UPSTREAM)
    strides = state_property(operation, "strides", LAID_OUT, _compare_layouts, UPSTREAM | VIEWS)
    yield replace(strides, combined=("layout", "of"))
    few = UPSTREAM | LAYOUT | _sizes_up_to_dense(operation)
    yield state_property(operation, "dtype", PRECISE, _compare_dtypes, few)
    yield state_property(operation, "purity", PURE, _compare_inputs, UPSTREAM | WRITABLE)
    classes = UPSTREAM | WRITABLE | _few_values_of(operation)
    independence = state_property(operation, "independence", INDEPENDENT, _compare_calls, classes)
    yield replace(independence, examples=HISTORIES)
    if operation.has_right_gradients:
        yield _state_special_inputs(operation)


POINTS = 2
"""The points of the value and of each gradient; every other property has one."""
HISTORIES = 16
"""Independence is tried on at least so many cases, each of which is ten calls or more."""
LAYOUT: dict[str, tuple] = {"layout": tuple(LAYOUTS)}
WRITABLE: dict[str, tuple] = {"layout": tuple(LAYOUTS)[:-2]}
"""The layouts in which a function can alter what it is given."""
VIEWS: dict[str, tuple] = {
    "layout": tuple(LAYOUTS)[1:],
    "values": (ORDINARY, "random", "ties"),
}
"""The layouts of views, and classes of values that show which entry was read."""
SIMILAR_SIZES: dict[str, tuple] = {
    "values": (ORDINARY, "random", "ties", "large", "constant", "repeated slices")
}
"""Classes whose entries are of similar size, so that rounding of large ones hides no small one."""
TIED: dict[str, tuple] = {
    "values": ("ties", "signed zeros", "equal slices", "symmetric", "constant", THE_SAME)
}
"""Classes of values with equal entries."""
VALUE_STATEMENT = "the value is that of the definition, loop by loop"
TIES = "along directions that keep equal entries equal, the gradients give the slope of the value"
LINEAR = "the pullback is linear: for 2 dy - 3 dy' it returns 2 and -3 times that of each"
LAID_OUT = "views in any memory order, or that cannot be written, give the same as copies"
PRECISE = "float32 stays float32, with its precision, float64 likewise"
PURE = "no argument and no upstream gradient is altered"
INDEPENDENT = "a pullback called again returns the same, whatever was called in between"


def own_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has: ties, bounds, limits, zeros.

    They are rows of the table `operations.toml`. Where one says what the definition returns for one
    class of values, it has no function of its own.
    """
    for row in TABLE["properties"]:
        if operation.name in row["operations"].split():
            pairs = OWN_CHECKS.get(row["name"], compare_with_definition)
            classes = UPSTREAM | sizes_of(row.get("sizes", {}))
            yield state_property(operation, row["name"], row["statement"], pairs, classes)


def state_property(
    operation: Operation,
    name: str,
    statement: str,
    pairs: MakePairs,
    classes: Mapping[str, tuple],
) -> Property:
    """A property of an operation, tried with its sizes and further classes."""
    return Property(
        name,
        statement,
        Comparison(operation, pairs),
        sizes={**operation.sizes, **classes},
        operation=operation.name,
        arguments=operation.arguments,
        group=REST,
        seeded_by=operation.seeded_by,
    )


def _state_gradient(operation: Operation, name: str) -> Property:
    """The property about the gradient for one argument."""
    right = "the definition" if operation.has_right_gradients else "central differences"
    statement = f"the pullback's gradient for {name} is that of {right}"
    classes = {**UPSTREAM, **operation.without_ties}
    pairs = partial(_compare_gradient, name)
    gradient = state_property(operation, f"gradient for {name}", statement, pairs, classes)
    return replace(gradient, points=POINTS, group=GRADIENT)


SPECIAL_UPSTREAM = (ORDINARY, "random", "integers", "sparse")
"""The classes of upstream gradients of the property "special inputs"."""
FULL_SIZE_CLASSES: tuple[dict[str, str], ...] = (
    {},
    {"state": ORDINARY, "upstream": "sparse"},
    {"state": ORDINARY, "values": "huge", "of": "b"},
)
"""Classes tried with the project's sizes. Where a state is kept: one gradient far back, and gates
that pass the state over all frames."""
LARGEST = "special inputs"
"""The name of the property with the largest arrays."""
SPECIAL = "equal, sorted, zero, wide, large or long arrays too give what the definition gives"


def _state_special_inputs(operation: Operation) -> Property:
    """The property that tries large sizes, and every class of values in each array."""
    sizes = {}
    for size, options in operation.sizes.items():
        sizes[size] = (*options, *operation.longer.get(size, ()))
    sizes["upstream"] = SPECIAL_UPSTREAM
    special = state_property(operation, LARGEST, SPECIAL, compare_with_definition, sizes)
    return replace(special, combined=("values", "of"), full_size_classes=FULL_SIZE_CLASSES)


FEW_VALUES = (ORDINARY, "random", "zeros", "ties", "large", "constant", "wide", THE_SAME)
"""The classes of values of independence, which is about calls more than about numbers."""


def _few_values_of(operation: Operation) -> dict[str, tuple]:
    """The classes of values of an operation that are among FEW_VALUES."""
    values = tuple(name for name in operation.sizes.get("values", ()) if name in FEW_VALUES)
    return {"values": values} if values else {}


DENSE = 33
"""The largest size of "dtype" for operations of one's own: ordinary numbers are distinct and so
near to each other in larger arrays that a right layer may amplify the rounding of float32."""


def _sizes_up_to_dense(operation: Operation) -> dict[str, tuple]:
    """The sizes that have the option DENSE, without larger ones."""
    few = {}
    for size, options in operation.sizes.items():
        if DENSE in options:
            few[size] = options[: options.index(DENSE) + 1]
    return few


def _compare_value(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare the value, then that of a call with all but one argument, or only one, replaced."""
    arguments = operation.arguments(case)
    value, _ = call_for_array(implementation, copy_inputs(arguments))
    expected = operation.value(*copy_inputs(arguments))
    yield Pair(THE_VALUE, value, expected, floor=operation.floor)
    next_arguments = operation.arguments(Case(case.sizes, case.seed + 1))
    name = list(arguments)[case.seed // 2 % len(arguments)]
    if case.seed % 2 == 0:
        changed = {**next_arguments, name: arguments[name]}
        subject = f"of the same {name} after a first call, the value"
    else:
        changed = {**arguments, name: next_arguments[name]}
        subject = f"of another {name} after a first call, the value"
    value, _ = implementation(*copy_inputs(changed))
    yield Pair(subject, value, operation.value(*copy_inputs(changed)))


def _compare_gradient(
    argument: str, operation: Operation, implementation: Callable, case: Case
) -> Pairs:
    """Compare with the definition's gradient, or with differences if the value is wrong."""
    arguments = operation.arguments(case)
    value, _ = call_for_array(implementation, copy_inputs(arguments))
    subject = f"the gradient for {argument}"
    inputs: Inputs = {}
    right: Results = {}
    if operation.reference is not None:
        inputs, right = right_results(operation, case)
    has_right_value = bool(right) and agrees(value, right[THE_VALUE])
    is_by_definition = has_right_value and not (operation.by_differences and case.is_plain)
    if is_by_definition:
        gradient = results_of(operation, implementation, copy_inputs(inputs))[subject]
        floor = operation.floor_of(inputs[THE_UPSTREAM])
        tolerance = rounding_of(case, inputs)
        expected = right[subject]
        yield canonical_pair(operation, inputs, subject, gradient, expected, tolerance, floor)
        return
    is_ordinary = case.get("values") == ORDINARY and case.get("state") == ORDINARY
    if operation.reference is not None and not is_ordinary:
        return
    problem = _find_wrong_gradient(argument, operation, implementation, case)
    if problem is None:
        return
    if has_right_value:  # so that a report shows both
        results = results_of(operation, implementation, copy_inputs(inputs))
        problem.result = results[subject]
        problem.expected = right[subject]
    raise problem


def _find_wrong_gradient(
    argument: str, operation: Operation, implementation: Callable, case: Case
) -> Mismatch | None:
    """What differences of the value say against the gradient for an argument, or None."""
    arguments = operation.arguments(case)
    names = operation.differentiated

    def f(*inputs: np.ndarray) -> tuple[np.ndarray, Callable]:
        named = arguments | dict(zip(names, inputs, strict=True))
        value, pullback = call_for_array(implementation, copy_inputs(named))
        return value, lambda dy: pullback(copy_upstream(dy))

    problems = find_wrong_gradients(
        f,
        [arguments[name] for name in names],
        names,
        case.rng(),
        only=(argument,),
        upstream=partial(draw_upstream, case),
        kinks_excused=1.0,
    )
    implementation(*copy_inputs(arguments))  # the call that a report shows
    return problems[0] if problems else None


ADJOINT = 1e-12
"""Both inner products of an adjoint may differ by so much, relative to the norms of the factors."""
ADJOINT_IN_FLOAT32 = 1e-4
"""The same where an argument is an array of float32."""


def _compare_inner_products(
    argument: str, operation: Operation, implementation: Callable, case: Case
) -> Pairs:
    """Compare <A x, dy> with <x, A' dy>, without the bias, which is not linear."""
    inputs = inputs_of(operation, implementation, case)
    if "b" in inputs and not operation.is_own:
        inputs["b"] = np.zeros_like(inputs["b"])
    results = results_of(operation, implementation, copy_inputs(inputs))
    value = results[THE_VALUE]
    pulled = results[f"the gradient for {argument}"]
    yield Pair("A' dy", pulled, pulled)  # before the check may fail, for the diagnosis
    if max(np.max(np.abs(value)), np.max(np.abs(pulled))) > EXACT:  # or its terms cancel
        tolerance = ADJOINT_IN_FLOAT32 if operation.takes_float32(case) else ADJOINT
        tolerance = max(tolerance, operation.nondeterminism)
        x = inputs[argument]
        check_adjoint(lambda x: (value, lambda dy: pulled), x, inputs[THE_UPSTREAM], tolerance)


class _Call:
    """A call of an operation: its value, a copy of it, its pullback and an upstream gradient."""

    def __init__(self, operation: Operation, implementation: Callable, inputs: list) -> None:
        *arguments, self.dy = inputs
        self.operation = operation
        self.value, self.pullback = implementation(*arguments)
        self.value_at_first = np.copy(self.value)

    def results(self, dy: Upstream | None = None) -> Results:
        """The value and the gradients by name, by default for the call's own upstream gradient."""
        pulled = self.pullback(copy_upstream(self.dy if dy is None else dy))
        return name_results(self.operation, self.value, pulled)

    def copied_results(self) -> Results:
        """Copies of the results, the value as it was before the pullback was called."""
        copies = {name: np.copy(result) for name, result in self.results().items()}
        return copies | {THE_VALUE: self.value_at_first}


def _compare_multiples(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Give three upstream gradients in the same array, after the value was deleted."""
    *arguments, first = copy_inputs(inputs_of(operation, implementation, case))
    pullback = implementation(*arguments)[1]
    second = np.flip(first).copy() if np.ndim(first) else 1 / 3
    dy = np.copy(first)
    results = []
    for upstream in (first, second, 2 * first - 3 * second):
        dy[...] = upstream
        pulled = pullback(dy if np.ndim(first) else upstream)
        named = name_results(operation, 0.0, pulled)
        results.append({name: np.copy(gradient) for name, gradient in named.items()})
    of_first, of_second, of_both = results
    for name, gradient in of_both.items():
        expected = 2 * of_first[name] - 3 * of_second[name]
        terms = max(1.0, _largest(first) / _largest(expected))  # large terms may cancel in a sum
        yield Pair(f"of 2 dy - 3 dy' {name}", gradient, expected, EXACT * terms)


def _compare_dtypes(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare float32 with float64; arguments changed by rounding give the error allowed."""
    if _is_decided_by_rounding(operation, case):
        return
    layout = _layout_of(operation, case)
    inputs = inputs_of(operation, implementation, case)
    in_single = {}
    for name, argument in zip(inputs, copy_inputs(inputs, layout), strict=True):
        in_single[name] = _in_float32(argument)
    in_double, *rounded = _results_in_float64(operation, implementation, in_single)
    results = results_of(operation, implementation, copy_inputs(in_single, layout))
    for name, result in results.items():
        if not operation.has_right_value:
            require_finite(f"of float64, {name}", in_double[name])
        _require_dtype(name, in_double[name], np.float64)
        _require_dtype(name, result, np.float32)
        expected = operation.canonical(in_single, in_double[name])
        if np.all(np.isfinite(expected)):
            change = max(_largest_difference(moved[name], in_double[name]) for moved in rounded)
            allowed = _error_of_float32(operation, in_single, expected, change)
            off = operation.canonical(in_single, np.asarray(result, np.float64)) - expected
            yield Pair(f"of float32, the error of {name}", off, np.zeros_like(off), allowed)


def _is_decided_by_rounding(operation: Operation, case: Case) -> bool:
    """Whether a right result of float32 may be far from that of float64.

    Rounding may turn a gate, and all frames that follow, or the order of two entries; and equal
    entries cancel in general functions.
    """
    if case.get("state") == "huge" or case.get("values") == "near ties":
        return True
    return case.get("layout") == "broadcast" and not operation.has_right_gradients


FLOAT32_ULPS = 64
"""A result of float32 may be off by so many roundings of float32."""
OWN_ULPS = 1024
"""The same for an operation of one's own, whose terms may cancel."""


FLOAT32 = float(np.finfo(np.float32).eps)


def _error_of_float32(
    operation: Operation, inputs: Inputs, expected: np.ndarray, change: float
) -> float:
    """The error that float32 may have; `change` is what rounding the arguments changes."""
    *arguments, dy = inputs.values()
    floor = _largest(dy, *arguments) if operation.saturates else 1.0
    ulps = OWN_ULPS if operation.is_own else FLOAT32_ULPS
    return ulps * (FLOAT32 * max(floor, _largest(expected)) + change)


def _results_in_float64(
    operation: Operation, implementation: Callable, inputs: Inputs
) -> Iterator[Results]:
    """The results for float32 as float64: as they are, and twice changed by half a rounding."""
    rng = np.random.default_rng(0)
    drawn_by_caller = [inputs[name] for name in operation.drawn_by_caller]

    def widen(rounding: float, array: np.ndarray) -> np.ndarray:
        if array.dtype != np.float32:
            return array
        if any(array is drawn for drawn in drawn_by_caller):
            return array.astype(float)
        return array * (1.0 + rounding * rng.choice([-0.5, 0.5], array.shape))

    for rounding in (0.0, FLOAT32, FLOAT32):
        wide = copy_inputs(inputs, partial(widen, rounding))
        yield results_of(operation, implementation, wide)


def _layout_of(operation: Operation, case: Case) -> Callable[[np.ndarray], np.ndarray]:
    """The memory layout of a case; none that alters numbers which the caller has drawn."""
    name = case.get("layout")
    if name == "broadcast" and operation.drawn_by_caller:
        name = "read-only"
    return LAYOUTS[name]


def _in_float32(argument: Any) -> Any:
    """An argument rounded to float32; a number such as a bound stays a Python float."""
    if isinstance(argument, float):
        return float(np.float32(argument))
    return argument.astype(np.float32) if np.asarray(argument).dtype == np.float64 else argument


def _largest(*arrays: Any) -> float:
    """max |first entry| times max |entry of the others|, both at least 1."""
    sizes = [max(1.0, float(np.max(np.abs(array), initial=0.0))) for array in arrays]
    return sizes[0] * max(sizes[1:], default=1.0)


def _largest_difference(first: Any, second: Any) -> float:
    return float(np.max(np.abs(first - second), initial=0.0))


def _require_dtype(subject: str, result: Any, dtype: type) -> None:
    """Raise a Mismatch unless a result has this dtype (`has_dtype`)."""
    if not has_dtype(result, dtype):
        actual = np.asarray(result).dtype
        raise Mismatch(DTYPE, subject, f"given {np.dtype(dtype)}, {subject} is {actual}")


def _compare_inputs(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare the arguments after the call, and all inputs after the pullback was called twice."""
    inputs = inputs_of(operation, implementation, case)
    copies = copy_inputs(inputs, _layout_of(operation, case))
    call = _Call(operation, implementation, copies)
    yield from compare_with_copies(copies, inputs, "call")
    for dy in (call.dy, copy_upstream(call.dy)):
        pulled = call.pullback(dy)
        if not operation.has_right_value:
            for name, result in name_results(operation, call.value, pulled).items():
                require_finite(name, result)
        yield from compare_with_copies([*copies[:-1], dy], inputs, "pullback")


FURTHER_CALLS = 7
"""In some cases a result is compared again after so many further calls."""


def _compare_calls(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Alternate between two calls, overwrite results, then change the arguments in place.

    In some cases the results of the first call are kept over eight calls.
    """
    other_case = Case(case.sizes, case.seed + 1)
    other_inputs = inputs_of(operation, implementation, other_case)
    inputs = inputs_of(operation, implementation, case)
    layout = _layout_of(operation, case)
    reused = copy_inputs(inputs, layout)
    right = _Call(operation, implementation, reused).copied_results()
    first = _Call(operation, implementation, copy_inputs(inputs, layout))
    second = _Call(operation, implementation, copy_inputs(other_inputs, layout))
    returned = first.results()
    if case.seed % 4 == 0:
        for _ in range(FURTHER_CALLS):
            _Call(operation, implementation, copy_inputs(other_inputs)).results()
    second_right = second.copied_results()
    first.results(second.dy)
    for name, result in returned.items():
        subject = f"after further calls, {name} that was returned first"
        yield Pair(subject, result, right[name], kind=OVERWRITTEN)
        _overwrite(result, first.value)
    for call, expected in ((first, right), (second, second_right)):
        for name, result in call.results().items():
            yield Pair(f"called again, {name}", result, expected[name])
    implementation(*reused[:-1])
    reused = _fill_with(reused, other_inputs)
    for name, result in results_of(operation, implementation, reused).items():
        yield Pair(f"of the same arrays with other numbers, {name}", result, second_right[name])
    if not operation.drawn_by_caller:
        yield _compare_one_entry(operation, implementation, case, reused[:-1])


def _overwrite(result: Any, value: Any) -> None:
    """Overwrite a gradient that was returned, as a caller may."""
    if result is not value and isinstance(result, np.ndarray) and result.flags.writeable:
        result[...] = np.nan


def _fill_with(reused: list, inputs: Inputs) -> list:
    """The same arrays with the numbers of other inputs; other numbers in place of numbers."""
    filled = []
    for array, numbers in zip(reused, inputs.values(), strict=True):
        if isinstance(numbers, np.ndarray):
            array[...] = numbers
            filled.append(array)
        else:
            filled.append(numbers)
    return filled


def _compare_one_entry(
    operation: Operation, implementation: Callable, case: Case, arrays: list
) -> Pair:
    """Change one entry in place between two calls, to what it is in the case itself."""
    arguments = operation.arguments(case)
    names = operation.differentiated
    name = names[case.seed % len(names)]
    array = arrays[list(arguments).index(name)]
    entry = case.seed // len(names) % array.size
    array.flat[entry] = arguments[name].flat[entry]
    copies = copy_inputs(dict(zip(arguments, arrays, strict=True)))
    if operation.has_right_value:
        expected = operation.value(*copies)
    else:
        expected = np.copy(implementation(*copies)[0])
    value = implementation(*arrays)[0]
    subject = f"of the same arrays with one other entry of {name}, the value"
    return Pair(subject, value, expected)


def _compare_layouts(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare the results for arrays in a memory layout with those for copies of them."""
    inputs = inputs_of(operation, implementation, case)
    chosen = (case.get("of"), THE_UPSTREAM)
    laid_out = dict(zip(inputs, copy_inputs(inputs, _layout_of(operation, case)), strict=True))
    for name in inputs:
        if case.get("of") == ORDINARY or name in chosen:
            inputs[name] = laid_out[name]
    expected = _Call(operation, implementation, copy_inputs(inputs)).copied_results()
    for name, result in results_of(operation, implementation, inputs.values()).items():
        subject = f"of arrays {case.get('layout')}, {name}"
        yield canonical_pair(operation, inputs, subject, result, expected[name])


def _compare_zeros(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """What is 0 by the definition has to be 0, without rounding."""
    inputs, right = right_results(operation, case)
    for name, result in results_of(operation, implementation, copy_inputs(inputs)).items():
        require_shape(name, result, np.shape(right[name]))
        is_zero = right[name] == 0
        yield Pair(name, np.where(is_zero, result, 0), np.zeros_like(right[name]), 0)


def _compare_default(operation: Operation, loss: Callable, case: Case) -> Pairs:
    """Compare the pullback of a loss without an argument with that for 1."""
    for dtype in (np.float64, np.float32):
        arrays = [array.astype(dtype) for array in operation.arguments(case).values()]
        _, pullback = loss(*arrays)
        by_default = pullback()
        yield Pair("by default the gradient", by_default, pullback(1.0), 0)
        _require_dtype("by default the gradient", by_default, pullback(1.0).dtype)


OWN_CHECKS: dict[str, MakePairs] = {
    "zero at the target": _compare_zeros,
    "empty slot": _compare_zeros,
    "upstream default": _compare_default,
}
"""What is compared for the properties of these names; for others the definition's results."""
