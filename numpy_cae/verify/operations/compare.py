"""How the results of an implementation are compared with what they should be."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from numpy_cae.verify.checks.differences import is_of_float32
from numpy_cae.verify.checks.messages import texts_that_differ
from numpy_cae.verify.checks.mismatch import (
    ALTERED,
    NUMBER,
    Mismatch,
    kind_and_subject,
    require_finite,
    require_shape,
)
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.results import (
    Inputs,
    copy_inputs,
    results_of,
    right_results,
)
from numpy_cae.verify.operations.upstream import THE_UPSTREAM

EXACT = 1e-10
"""Results of float64 agree if they differ by at most this, relative to the largest entry."""
SINGLE_EXACT = 1e-3
"""The same for operations of one's own that are tried or compute in float32 only."""


@dataclass(frozen=True, eq=False)
class Pair:
    """A result of an implementation, beside what it should be."""

    subject: str
    result: Any
    expected: Any
    tolerance: float = EXACT
    floor: float | None = None
    kind: str = NUMBER


Pairs = Iterator[Pair]


@dataclass(frozen=True)
class Comparison:
    """The check of an operation's property: every result is as expected."""

    operation: Operation
    pairs: Callable[[Operation, Callable, Case], Pairs]

    def __call__(self, implementation: Callable, case: Case) -> None:
        for pair in self.pairs(self.operation, implementation, case):
            if self.operation.is_own:
                pair = self._of_own_operation(pair, case)
            require_pair(pair)

    def _of_own_operation(self, pair: Pair, case: Case) -> Pair:
        """The pair with the tolerance of the coarsest array that went in.

        Where nothing says what is right, a result has to be finite.
        """
        if not self.operation.has_right_value:
            require_finite(pair.subject, pair.result)
        if not pair.tolerance:
            return pair
        tolerance = max(pair.tolerance, self.operation.nondeterminism)
        if _is_in_single(pair) or self.operation.takes_float32(case):
            tolerance = max(tolerance, SINGLE_EXACT)
        return replace(pair, tolerance=tolerance)

    def results(self, implementation: Callable, case: Case) -> list[np.ndarray]:
        """All results of an implementation; if it raises, what failed comes last."""
        results = []
        try:
            with np.errstate(all="ignore"):
                for pair in self.pairs(self.operation, implementation, case):
                    results.append(np.copy(pair.result))
        except (Exception, SystemExit) as error:
            results.append(np.array(kind_and_subject(error)))
        return results


def _is_in_single(pair: Pair) -> bool:
    """Whether the expected result, or the result, has the digits of float32 only."""
    return np.asarray(pair.expected).dtype == np.float32 or is_of_float32(pair.result)


def require_pair(pair: Pair) -> None:
    """Raise a Mismatch unless both arrays of a pair agree, as `require_equal` does."""
    require_equal(pair.subject, pair.result, pair.expected, pair.tolerance, pair.floor, pair.kind)


NUMBER_DIGITS = 10
"""The two numbers of a mismatch have at least this many digits."""


def require_equal(
    subject: str,
    result: Any,
    expected: Any,
    tolerance: float = EXACT,
    floor: float | None = None,
    kind: str = NUMBER,
) -> None:
    """Raise a Mismatch unless two arrays agree, to rounding, in every entry.

    The tolerance is relative to the largest entry. With a floor, the tolerance is relative to
    each entry, plus the floor. Entries that should not be finite are left out.
    """
    result = np.asarray(result)
    expected = np.asarray(expected)
    require_shape(subject, result, expected.shape)
    finite = np.isfinite(expected)
    result = np.where(finite, result, 0)
    expected = np.where(finite, expected, 0)
    allowed = _allowed_difference(np.abs(expected), tolerance, floor)
    off = np.abs(result - expected)
    if np.all(off <= allowed):
        return
    excess = np.where(off <= allowed, -1.0, np.nan_to_num(off - allowed, nan=np.inf))
    index = tuple(map(int, np.unravel_index(np.argmax(excess), off.shape)))
    place = f" at index {index}" if index else ""
    rounding = float(np.broadcast_to(allowed, off.shape)[index])
    number = _number_or_zero(result[index], rounding)
    expected_number = _number_or_zero(expected[index], rounding)
    texts = texts_that_differ(number, expected_number, NUMBER_DIGITS)
    text = f"{subject} is {texts[0]}{place}, expected {texts[1]}"
    raise Mismatch(kind, subject, text, result, expected)


def _allowed_difference(
    size: np.ndarray, tolerance: float, floor: float | None
) -> np.ndarray | float:
    """By how much a result may differ from an entry of this size."""
    if floor is None:
        return tolerance * max(1.0, float(np.max(size, initial=0.0)))
    return tolerance * size + floor


def _number_or_zero(number: Any, rounding: float) -> float:
    """The number, or 0 where it is no more than rounding."""
    number = float(number)
    return 0.0 if abs(number) <= rounding else number


def agrees(result: Any, expected: Any) -> bool:
    """Whether two arrays agree, to rounding of the largest entry that is expected."""
    allowed = EXACT * max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    return np.shape(result) == np.shape(expected) and np.allclose(result, expected, 0, allowed)


def compare_with_definition(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare all results with the definition's, and the arguments with their copies."""
    inputs, right = right_results(operation, case)
    copies = copy_inputs(inputs)
    allowed = rounding_of(case, inputs)
    floor = operation.floor_of(inputs[THE_UPSTREAM])
    for name, result in results_of(operation, implementation, copies).items():
        yield canonical_pair(operation, inputs, name, result, right[name], allowed, floor)
    yield from compare_with_copies(copies, inputs, "function")


def canonical_pair(
    operation: Operation,
    inputs: Inputs,
    subject: str,
    result: Any,
    expected: Any,
    tolerance: float = EXACT,
    floor: float | None = None,
) -> Pair:
    """A pair of what is equal for all right gradients, such as any order of equal points."""
    result = operation.canonical(inputs, result)
    expected = operation.canonical(inputs, expected)
    return Pair(subject, result, expected, tolerance, floor)


BOUND_ROUNDINGS = 8
"""1 - y² of arctanh near its bound may be off by so many roundings of 1."""


def rounding_of(case: Case, inputs: Mapping[str, Any]) -> float:
    """The tolerance: EXACT, or more with a huge state, which multiplies the rounding of 1 - z.

    With a bound near 1 it is more as well: y² is rounded before it is subtracted from 1.
    """
    largest = 1.0
    if case.get("state") == "huge":
        *arguments, _ = inputs.values()
        largest = max(float(np.max(np.abs(array))) for array in arguments)
    bound = inputs.get("bound", 0.0)
    return max(EXACT * largest, BOUND_ROUNDINGS * float(np.finfo(float).eps) / (1 - bound))


def compare_with_copies(after: Iterable, before: Mapping[str, Any], by: str) -> Pairs:
    """The comparison of what a function or a pullback was given with copies, by name."""
    for (name, was), now in zip(before.items(), after, strict=True):
        subject = f"{name}, which the {by} must not alter,"
        yield Pair(subject, 1 * now, 1 * was, 0, None, ALTERED)
