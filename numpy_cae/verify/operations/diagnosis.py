"""The likely mistake because of which a property does not hold.

That is a wrong operation that does the same. The implementation, the right operation, each planted
bug and each other convention are tried with the cases of the property. A mistake is named only if
the wrong operation does in every case what the implementation does, and the right operation in
several cases does not. Otherwise the sentence says what was seen: a factor, lost digits, or what
the cases that fail have in common.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import permutations, zip_longest
from operator import itemgetter
from typing import Any

import numpy as np

from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.compare import Comparison
from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.patch import bugs_of, conventions_of
from numpy_cae.verify.operations.property import Property

SEVERAL = 2
"""A mistake is named only if the right operation differs in at least this many cases."""

CaseResults = list[np.ndarray]
"""All results of one implementation in one case."""


@dataclass(frozen=True, eq=False)
class _Trials:
    """The results of an implementation and of the right operation in the cases of a property."""

    property_: Property
    comparison: Comparison
    implementation: Callable
    cases: Sequence[Case]
    results: Sequence[CaseResults]
    right: Sequence[CaseResults]

    @property
    def fails(self) -> list[bool]:
        """In which cases the implementation does something else than the right operation."""
        pairs = zip(self.results, self.right, strict=True)
        return [not same(results, right) for results, right in pairs]


def likely_mistake(property_: Property, implementation: Callable, of_kind: str = "") -> str:
    """The sentence on the mistake because of which a property does not hold, or "".

    `of_kind` is what the kind of a failure tells: it is said where no known mistake does the same.
    """
    if property_.diagnose is not None:
        return property_.diagnose(property_, implementation)
    operation = property_.definition
    comparison = property_.comparison
    if operation is None or comparison is None or operation.reference is None:
        return ""
    cases = property_.cases()
    results = [comparison.results(implementation, case) for case in cases]
    right = [comparison.results(operation.reference, case) for case in cases]
    trials = _Trials(property_, comparison, implementation, cases, results, right)
    if sum(trials.fails) < SEVERAL:
        return ""
    return (
        _known_mistake(trials)
        or misplaced_gradient(property_, operation, implementation)
        or of_kind
        or _factor_or_lost_digits(trials)
        or _circumstance(trials)
    )


def _known_mistake(trials: _Trials) -> str:
    """The sentence on the first planted bug or convention that does the same, or "".

    Those that the property is meant for come first.
    """
    name = trials.comparison.operation.name
    patches = [*bugs_of(name), *conventions_of(name)]
    patches.sort(key=lambda patch: patch.caught_by != trials.property_.name)
    for patch in patches:
        if _does_the_same(trials, patch.function()):
            if patch.caught_by:
                return patch.sentence
            return f"another convention, which may be allowed: {patch.sentence}"
    return ""


def _does_the_same(trials: _Trials, wrong: Callable) -> bool:
    """Whether a wrong operation returns in every case what the implementation returns."""
    for case, results in zip(trials.cases, trials.results, strict=True):
        if not same(results, trials.comparison.results(wrong, case)):
            return False
    return True


def misplaced_gradient(property_: Property, operation: Operation, implementation: Callable) -> str:
    """Where the right gradient stands among those that the pullback returns, or ""."""
    names = operation.differentiated
    name = property_.name.removeprefix("gradient for ")
    if name not in names:
        return ""
    for place in names:
        if place == name:
            continue
        exchanged = partial(_exchange_gradients, names, name, place, implementation)
        if failing_case(property_, exchanged) is None:
            order = ", ".join(names)
            return f"The gradient for {name} is returned as that for {place}: the order is {order}."
    return ""


def _exchange_gradients(
    names: Sequence[str], first: str, second: str, implementation: Callable, *arguments: Any
) -> tuple[Any, Callable]:
    """Call the implementation, and let its pullback exchange the gradients for two arguments."""
    value, pullback = implementation(*arguments)
    order = list(range(len(names)))
    order[names.index(first)] = names.index(second)
    order[names.index(second)] = names.index(first)
    return value, lambda *upstream: itemgetter(*order)(pullback(*upstream))


LOST_DIGITS = 1e-5
"""Results lose digits only if they are off by less than this part of the largest entry."""


def _factor_or_lost_digits(trials: _Trials) -> str:
    """The factor by which all results are off, made of sizes, or the digits that are lost."""
    rows = []
    for results, right in zip(trials.results, trials.right, strict=True):
        if any(array.dtype.kind != "f" for array in results):  # it raises
            return ""
        if [array.shape for array in results] != [array.shape for array in right]:
            return ""
        rows.append((_row(results), _row(right)))
    factor = _factor(trials.cases, rows)
    if factor:
        return f"It is the right result times {factor}."
    off = np.max([_relative_error(row, right_row) for row, right_row in rows])
    if 0 < off < LOST_DIGITS:
        return f"Digits are lost: it is off by at most {off:.0e}, relatively."
    return ""


SAME_FACTOR = 1e-9
"""A result is the right one times a factor if it differs by at most this part."""


def _factor(cases: Sequence[Case], rows: Sequence[tuple[np.ndarray, np.ndarray]]) -> str:
    """The factor between all results and the right ones, such as "batch / 2", or ""."""
    numbers = [{"1": 1, "-1": -1, "2": 2} | _numbers(case) for case in cases]
    for above, below in permutations(numbers[0], 2):
        if all(
            np.allclose(row, right_row * of_case[above] / of_case[below], SAME_FACTOR, 1e-12)
            for of_case, (row, right_row) in zip(numbers, rows, strict=True)
        ):
            return f"{above} / {below}".removesuffix(" / 1")
    return ""


def _relative_error(row: np.ndarray, right_row: np.ndarray) -> float:
    """The largest error, relative to the largest right number or to 1."""
    return np.max(abs(row - right_row), initial=0) / np.max(abs(right_row), initial=1)


MOST = 0.6
"""A circumstance is named if at least so large a part of its cases fail, and no others."""


def _circumstance(trials: _Trials) -> str:
    """What all cases that fail have in common, and most that hold have not, or ""."""
    failing: list[set[str]] = []
    counts: Counter[str] = Counter()
    seen = 0
    for case, fails, right in zip(trials.cases, trials.fails, trials.right, strict=True):
        if not fails and not np.any(_row(right)):
            continue  # nothing is seen where all results are 0
        seen += 1
        conditions = _conditions(trials.property_, case)
        counts.update(conditions)
        if fails:
            failing.append(conditions)
    best = ""
    for name in sorted(set.intersection(*failing)):
        is_rarer = not best or counts[name] < counts[best]
        if seen - counts[name] >= SEVERAL and is_rarer:
            best = name
    if not best:
        return ""
    most = 1 if best.endswith(("odd", "even")) else MOST
    if len(failing) < most * counts[best]:
        return ""
    return f"It fails only where {best}: in {len(failing)} of {counts[best]} cases."


def _conditions(property_: Property, case: Case) -> set[str]:
    """What is true of the sizes, the classes and the arguments of a case."""
    conditions = set()
    for name, option in case.sizes:
        if option == 1 or isinstance(option, str):
            conditions.add(f"{name} is {option}")
    conditions.update(_conditions_of_numbers(property_, _numbers(case)))
    for name, array in property_.arguments(case).items():
        if not np.all(array):
            conditions.add(f"{name} has a 0")
    return conditions


def _conditions_of_numbers(property_: Property, numbers: dict[str, int]) -> Iterator[str]:
    """What is true of the sizes that are numbers."""
    for name, size in numbers.items():
        yield f"{name} is {'odd' if size % 2 else 'even'}"
        for option in property_.sizes[name]:
            if size > option:
                yield f"{name} is above {option}"


def _row(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """The entries of all arrays in one row."""
    return np.concatenate([np.zeros(0), *map(np.ravel, arrays)])


def _numbers(case: Case) -> dict[str, int]:
    """The sizes of a case that are numbers."""
    return {name: size for name, size in case.sizes if isinstance(size, int)}


def same(results: list, expected: list) -> bool:
    """Whether two lists of results are equal, to rounding of the largest of them."""
    return len(results) == len(expected) and not _differing(results, expected)


ROUNDING = 1e-11
"""Results are equal if they differ by at most this much of the largest of them."""


def _differing(results: list, expected: list) -> set[int]:
    """The numbers of the results that differ, beyond rounding of the largest of them."""
    largest = 0.0
    for array in expected:
        if array.dtype.kind == "f":
            finite = array[np.isfinite(array)]
            largest = max(largest, float(np.max(np.abs(finite), initial=0.0)))
    differing = set()
    for number, (result, right) in enumerate(zip_longest(results, expected)):
        if not _equal(result, right, ROUNDING * largest):
            differing.add(number)
    return differing


CLOSE = 1e-9
"""Entries of float64 are equal if they differ by at most this part."""
CLOSE_IN_SINGLE = 1e-4
"""Entries of float32 are equal if they differ by at most this part."""


def _equal(result: np.ndarray | None, expected: np.ndarray | None, rounding: float) -> bool:
    """Whether two results are equal, to rounding; None is equal to nothing."""
    if result is None or expected is None:
        return False
    if result.shape != expected.shape or result.dtype != expected.dtype:
        return False
    if result.dtype.kind != "f":
        return np.array_equal(result, expected)
    close = CLOSE_IN_SINGLE if result.dtype == np.float32 else CLOSE
    absolute = close / CLOSE * rounding
    return np.allclose(result, expected, rtol=close, atol=absolute, equal_nan=True)
