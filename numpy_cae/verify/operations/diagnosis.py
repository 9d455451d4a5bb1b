"""The likely mistake of an implementation that fails: a wrong operation that does the same.

The implementation, the right operation, each planted bug and each other convention are tried with
the cases of the property. A mistake is named only if the wrong operation does in every case what
the implementation does, and the right operation in several cases does not.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import zip_longest

import numpy as np

from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.patch import bugs_of, conventions_of
from numpy_cae.verify.operations.property import Property, compared, property_of

SEVERAL = 2
"""SEVERAL: a mistake is named only if the right operation differs in at least so many cases."""
GENERAL_CASES = 8
"""GENERAL_CASES: two mistakes that explain the same are compared in so many further cases."""


def likely_mistake(stated: Property, implementation: Callable) -> str:
    """The sentence on the mistake because of which a property does not hold, or ""."""
    if stated.diagnose is not None:
        return stated.diagnose(stated, implementation)
    operation = stated.definition
    if operation is None:
        return ""
    mistake = _known_mistake(stated, operation, implementation)
    return mistake or misplaced_gradient(stated, operation, implementation)


def misplaced_gradient(stated: Property, operation: Operation, implementation: Callable) -> str:
    """Where the right gradient stands among those that the pullback returns, or ""."""
    names = operation.differentiated
    name = stated.name.removeprefix("gradient for ")
    if name not in names or len(names) < 2:
        return ""
    for place, other in enumerate(names):
        if other != name and _holds(stated, _moved(implementation, place, names.index(name))):
            order = ", ".join(names)
            return f"The gradient for {name} is returned as that for {other}: the order is {order}."
    return ""


def _moved(implementation: Callable, old: int, new: int) -> Callable:
    """The implementation with two of its gradients exchanged."""

    def moved(*arguments):
        value, pullback = implementation(*arguments)

        def pull(*upstream):
            gradients = list(pullback(*upstream))
            gradients[new], gradients[old] = gradients[old], gradients[new]
            return tuple(gradients)

        return value, pull

    return moved


def _holds(stated: Property, implementation: Callable) -> bool:
    try:
        for case in stated.cases():
            stated.check(implementation, case)
    except Exception:  # another mistake
        return False
    return True


def _known_mistake(stated: Property, operation: Operation, implementation: Callable) -> str:
    """The sentence on the planted bug that does the same, or ""."""
    cases = [case for case in stated.cases() if case.get("layout") != "read-only"]
    results = [stated.check.results(implementation, case) for case in cases]
    right = [stated.check.results(operation.reference, case) for case in cases]
    if sum(not same(one, other) for one, other in zip(results, right, strict=True)) < SEVERAL:
        return ""
    explained = {}
    for sentence, wrong in _wrong_operations(operation.name):
        pairs = zip(results, cases, strict=True)
        if all(same(one, stated.check.results(wrong, case)) for one, case in pairs):
            explained[sentence] = _shared_effects(operation, implementation, wrong)
    best = max(explained, key=explained.__getitem__, default="")
    return best if best and explained[best] >= 0 else ""


def _wrong_operations(name: str) -> Iterator[tuple[str, Callable]]:
    for bug in bugs_of(name):
        yield bug.sentence, bug.function()
    for convention in conventions_of(name):
        sentence = f"another convention, which may be allowed: {convention.sentence}"
        yield sentence, convention.function()


def _shared_effects(operation: Operation, implementation: Callable, wrong: Callable) -> int:
    """The number of results that a wrong operation changes; -1 if the implementation's differ."""
    general = property_of(operation, "diagnosis", "", compared)
    touched: set[int] = set()
    differing: set[int] = set()
    for case in replace(general, examples=GENERAL_CASES).cases():
        functions = (implementation, wrong, operation.reference)
        one, other, right = (general.check.results(f, case) for f in functions)
        touched |= _differing(other, right)
        differing |= _differing(other, one)
    return -1 if touched & differing else len(touched)


def same(one: list, other: list) -> bool:
    """Whether two lists of results are equal, to rounding of the largest of them."""
    return len(one) == len(other) and not _differing(one, other)


def _differing(one: list, other: list) -> set[int]:
    """The numbers of the results that differ, beyond rounding of the largest of them."""
    floats = [a for a in other if a.dtype.kind == "f"]
    sizes = (float(np.max(np.abs(a[np.isfinite(a)]), initial=0.0)) for a in floats)
    largest = max(sizes, default=0.0)
    pairs = enumerate(zip_longest(one, other))
    return {number for number, (a, b) in pairs if not _equal(a, b, 1e-11 * largest)}


def _equal(one: np.ndarray | None, other: np.ndarray | None, rounding: float) -> bool:
    if one is None or other is None or one.shape != other.shape or one.dtype != other.dtype:
        return False
    if one.dtype.kind != "f":
        return np.array_equal(one, other)
    close = 1e-4 if one.dtype == np.float32 else 1e-9
    return np.allclose(one, other, rtol=close, atol=close * 1e9 * rounding, equal_nan=True)
