"""The likely mistake of an implementation that fails: a wrong operation that does the same.

The implementation, the right operation, each planted bug and each other convention are tried with
the cases of the property. A mistake is named only if the wrong operation does in every case what
the implementation does, and the right operation in several cases does not. Otherwise the sentence
says what was seen: a factor, lost digits, or what the cases that fail have in common.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import permutations, zip_longest

import numpy as np

from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.patch import bugs_of, conventions_of
from numpy_cae.verify.operations.property import Property, compared, failing_case, property_of

SEVERAL = 2
"""SEVERAL: a mistake is named only if the right operation differs in at least so many cases."""
GENERAL_CASES = 8
"""GENERAL_CASES: two mistakes that explain the same are compared in so many further cases."""
DIGITS = 1e-5
"""DIGITS: results lose digits only if they are off by less than this part of the largest entry."""
MOST = 0.6
"""MOST: a circumstance is named if at least so large a part of its cases fail, and no others."""


def likely_mistake(stated: Property, implementation: Callable, of_kind: str = "") -> str:
    """The sentence on the mistake because of which a property does not hold, or "".

    `of_kind` is what the kind of a failure tells: it is said where no known mistake does the same.
    """
    if stated.diagnose is not None:
        return stated.diagnose(stated, implementation)
    operation = stated.definition
    if operation is None:
        return ""
    cases = stated.cases()
    results = [stated.check.results(implementation, case) for case in cases]
    right = [stated.check.results(operation.reference, case) for case in cases]
    fails = [not same(one, other) for one, other in zip(results, right, strict=True)]
    if sum(fails) < SEVERAL:
        return ""
    return (
        _known_mistake(stated, operation, implementation, cases, results)
        or misplaced_gradient(stated, operation, implementation)
        or of_kind
        or _by_how_much(cases, results, right)
        or _where(stated, cases, fails, right)
    )


def misplaced_gradient(stated: Property, operation: Operation, implementation: Callable) -> str:
    """Where the right gradient stands among those that the pullback returns, or ""."""
    names = operation.differentiated
    name = stated.name.removeprefix("gradient for ")
    if name not in names or len(names) < 2:
        return ""
    for place, other in enumerate(names):
        moved = _moved(implementation, place, names.index(name))
        if other != name and failing_case(stated, moved) is None:
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


def _known_mistake(
    stated: Property, operation: Operation, implementation: Callable, cases: list, results: list
) -> str:
    """The sentence on the planted bug that does the same, or ""."""
    explained = {"": -1}
    for sentence, wrong in _wrong_operations(operation.name):
        pairs = zip(results, cases, strict=True)
        if all(same(one, stated.check.results(wrong, case)) for one, case in pairs):
            explained[sentence] = _shared_effects(operation, implementation, wrong)
    return max(explained, key=explained.__getitem__)


def _by_how_much(cases: Sequence[Case], results: list, right: list) -> str:
    """The factor by which all results are off, made of sizes, or the digits that are lost."""
    if any(part.dtype.kind != "f" for parts in results for part in parts):  # it raises
        return ""
    pairs = [(_row(one), _row(other)) for one, other in zip(results, right, strict=True)]
    if any(one.shape != other.shape for one, other in pairs):
        return ""
    sizes = [{"1": 1, "-1": -1, "2": 2} | _numbers(case) for case in cases]
    for above, below in permutations(sizes[0], 2):
        scaled = [b * each[above] / each[below] for each, (_, b) in zip(sizes, pairs, strict=True)]
        if all(np.allclose(a, b, 1e-9, 1e-12) for (a, _), b in zip(pairs, scaled, strict=True)):
            return f"It is the right result times {f'{above} / {below}'.removesuffix(' / 1')}."
    off = np.max([np.max(abs(a - b), initial=0) / np.max(abs(b), initial=1) for a, b in pairs])
    return f"Digits are lost: it is off by at most {off:.0e}, relatively." * bool(off < DIGITS)


def _where(stated: Property, cases: Sequence[Case], fails: list[bool], right: list) -> str:
    """What all cases that fail have in common, and most that hold have not, or ""."""
    tried = [i for i, result in enumerate(right) if np.any(_row(result)) or fails[i]]
    conditions = [_conditions(stated, cases[i]) for i in tried]
    failed = [each for each, i in zip(conditions, tried, strict=True) if fails[i]]
    counts = Counter(name for each in conditions for name in each)
    shared = sorted(set.intersection(*failed))
    apart = [name for name in shared if len(tried) - counts[name] >= SEVERAL]
    best = min(apart, key=counts.__getitem__, default="")
    most = 1 if best.endswith(("odd", "even")) else MOST
    is_clear = best and len(failed) >= most * counts[best]
    return f"It fails only where {best}: in {len(failed)} of {counts[best]} cases." * bool(is_clear)


def _conditions(stated: Property, case: Case) -> set[str]:
    """What is true of the sizes, the classes and the arguments of a case."""
    numbers = _numbers(case)
    true = {f"{name} is {o}" for name, o in case.sizes if o == 1 or isinstance(o, str)}
    for name, size in numbers.items():
        true |= {f"{name} is {'odd' if size % 2 else 'even'}"}
        true |= {f"{name} is above {option}" for option in stated.sizes[name] if size > option}
        true |= {f"{name} is below {other}" for other in numbers if size < numbers[other]}
        true |= {f"{name} is as large as {o}" for o in numbers if o > name and size == numbers[o]}
    for name, array in stated.arguments(case).items():
        true |= {f"{name} is not 0"} if np.any(array) else set()
        true |= {f"{name} has a 0"} if not np.all(array) else set()
    return true


def _row(parts: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.zeros(0), *map(np.ravel, parts)])


def _numbers(case: Case) -> dict[str, int]:
    return {name: size for name, size in case.sizes if isinstance(size, int)}


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
