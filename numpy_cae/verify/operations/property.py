"""A property: a sentence about an operation, and the check that tests an implementation for it.

A check compares what an implementation returns with what it should return. The properties of all
operations, and of single ones, are in `shared_properties`.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from numpy_cae.verify.checks import call as calling
from numpy_cae.verify.checks.call import ALTERED, NUMBER, Mismatch
from numpy_cae.verify.checks.differences import is_of_float32
from numpy_cae.verify.operations.case import LAYOUTS, ORDINARY, Case, Sizes, random_cases, spread
from numpy_cae.verify.operations.operation import Operation

EXACT = 1e-10
"""EXACT: results of float64 agree if they differ by at most this, relative to the largest entry."""
SINGLE_EXACT = 1e-3
"""SINGLE_EXACT: the same for operations of one's own that are tried or compute in float32 only."""
EXAMPLES = 24
"""EXAMPLES: a property that does not set `examples` is tried on at least so many cases."""


def _single_entry(rng: np.random.Generator, dy: np.ndarray) -> np.ndarray:
    return np.where(np.arange(dy.size).reshape(dy.shape) == rng.integers(dy.size), dy, 0.0)


NUMBERS = {"zeros": 0, "integers": -3, "random": 0.7, "sparse": 0.0, "strided": 1.7}
NUMBERS |= {"constant": 1, "large": 1e3, "tiny": 1e-5}
ARRAYS: dict[object, Callable[[np.random.Generator, np.ndarray], np.ndarray]] = {
    "integers": lambda rng, dy: rng.choice([-3.0, 1.0, 2.0], dy.shape),
    "random": lambda rng, dy: rng.uniform(-8, 8, dy.shape),
    "sparse": _single_entry,
    "strided": lambda rng, dy: LAYOUTS["every other entry"](dy),
    "constant": lambda rng, dy: np.broadcast_to(2.0, dy.shape),
}
"""NUMBERS, ARRAYS: upstream gradients by class, of a number and of an array of ordinary entries."""
VALUE = 0
GRADIENT = 1
REST = 2
"""VALUE, GRADIENT, REST: what a property is about; a report gives points in this order."""
THE_UPSTREAM = "the upstream gradient"
"""THE_UPSTREAM: its name among the inputs of a call, where it follows the arguments."""
UPSTREAM = {"upstream": (ORDINARY, *NUMBERS)}
"""Upstream gradients: one class of arrays, or of scalars if the value is a scalar."""


class Pair(NamedTuple):
    """A result of an implementation, beside what it should be."""

    what: str
    result: object
    expected: object
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
            in_single = np.asarray(pair.expected).dtype == np.float32 or is_of_float32(pair.result)
            if self.operation.seeded_by and in_single and pair.tolerance:
                pair = pair._replace(tolerance=max(pair.tolerance, SINGLE_EXACT))
            require_equal(*pair)

    def results(self, implementation: Callable, case: Case) -> list:
        """All results of an implementation; if it raises, what failed comes last."""
        seen: list = []
        try:
            with np.errstate(all="ignore"):
                for pair in self.pairs(self.operation, implementation, case):
                    seen.append(np.copy(pair.result))
        except (Exception, SystemExit) as error:
            seen.append(np.array(calling.what_failed(error)))
        return seen


@dataclass(frozen=True)
class Property:
    """A sentence about a function, and the check that raises where the sentence is false.

    `operation` names the operation or exercise, `arguments` makes the arguments of a case.

    Examples
    --------
    >>> from numpy_cae import ops, verify
    >>> prop = verify.properties("conv1d")[0]
    >>> prop.name, prop.statement
    ('value', 'the value is that of the definition, loop by loop')
    >>> verify.check_property(prop, ops.conv1d)
    """

    name: str
    statement: str
    check: Callable[[Callable, Case], None] = field(repr=False)
    points: int = 1
    sizes: Sizes = field(default_factory=dict, repr=False)
    examples: int = EXAMPLES  # the number of cases
    operation: str = ""
    arguments: Callable[[Case], dict[str, object]] = field(default=lambda case: {}, repr=False)
    hint: str = ""
    combined: tuple[str, ...] = ()  # every combination of these sizes and classes is drawn
    together: tuple[dict[str, str], ...] = ()  # classes to try with the last option of every size
    diagnose: Callable[..., str] | None = field(default=None, repr=False)  # in place of diagnosis
    group: int = VALUE  # or GRADIENT, or REST: what functions without the right value may have
    example_of: str = ""  # how a report names it in a call of `example`
    seeded_by: str = ""  # what the cases depend on, by default the operation
    marks: tuple = ()  # of pytest

    def cases(self) -> list[Case]:
        """Random cases, the same in every run, smallest arrays first."""
        name = f"{self.seeded_by or self.operation}: {self.name}"
        return random_cases(name, self.sizes, self.examples, self.combined, self.together)

    @property
    def definition(self) -> Operation | None:
        """The operation, if its value and pullback have a definition to compare with."""
        operation = getattr(self.check, "operation", None)
        return operation if operation is not None and operation.reference else None


@dataclass(frozen=True)
class Outcome:
    """Whether a property holds; if not, why, in which case, and the likely mistake."""

    stated: Property
    held: bool
    problem: str = ""
    counterexample: str = ""
    mistake: str = ""
    kind: str = ""  # of the mismatch, or the type of another error
    crashed: bool = False  # whether the implementation raised


def failing_case(
    tried: Property, implementation: Callable, begin: Callable[[Case], None] = lambda case: None
) -> Case | None:
    """The first case in which a property does not hold, or None."""
    for case in tried.cases():
        begin(case)
        if failure(tried, implementation, case) is not None:
            return case
    return None


def failure(tried: Property, implementation: Callable, case: Case) -> BaseException | None:
    """The error that a check raises in a case, or None."""
    try:
        tried.check(implementation, case)
    except (Exception, SystemExit) as error:
        return error
    return None


def property_of(
    operation: Operation,
    name: str,
    statement: str,
    pairs: Callable[[Operation, Callable, Case], Pairs],
    classes: Mapping[str, tuple] = UPSTREAM,
    **others: object,
) -> Property:
    """A property of an operation, tried with its sizes and further classes."""
    options = {"group": REST, "arguments": operation.arguments, "operation": operation.name}
    options |= {"sizes": {**operation.sizes, **classes}, "seeded_by": operation.seeded_by}
    return Property(name, statement, Comparison(operation, pairs), **{**options, **others})


def require_equal(*pair: object) -> None:
    """Raise a Mismatch unless the two arrays of a `Pair` agree, to rounding, in every entry.

    The tolerance is relative to the largest entry. With a floor, the tolerance is relative to
    each entry, plus the floor. Entries that should not be finite are left out.
    """
    what, result, expected, tolerance, floor, kind = Pair(*pair)
    result = np.asarray(result)
    expected = np.asarray(expected)
    calling.require_shape(what, result, expected.shape)
    finite = np.isfinite(expected)
    result = np.where(finite, result, 0)
    expected = np.where(finite, expected, 0)
    size = np.abs(expected)
    if floor is None:
        allowed = tolerance * max(1.0, float(np.max(size, initial=0.0)))
    else:
        allowed = tolerance * size + floor
    off = np.abs(result - expected)
    if not np.all(off <= allowed):
        excess = np.where(off <= allowed, -1.0, np.nan_to_num(off - allowed, nan=np.inf))
        index = tuple(map(int, np.unravel_index(np.argmax(excess), off.shape)))
        place = f" at index {index}" if index else ""
        least = float(np.broadcast_to(allowed, off.shape)[index])  # what is smaller is rounding
        pair = (float(array[index]) for array in (result, expected))
        one, other = calling.written_apart(*(0.0 if abs(v) <= least else v for v in pair), 10)
        text = f"{what} is {one}{place}, expected {other}"
        raise Mismatch(kind, what, text, result, expected)


def agrees(result, expected) -> bool:
    """Whether two arrays agree, to rounding of the largest entry that is expected."""
    allowed = EXACT * max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    return np.shape(result) == np.shape(expected) and np.allclose(result, expected, 0, allowed)


def by_name(operation: Operation, value, pulled) -> dict[str, np.ndarray]:
    """A value and the gradients that its pullback returned, by name."""
    gradients = calling.gradients_of(pulled, len(operation.differentiated))
    if len(gradients) == 1 and isinstance(pulled, tuple | list):
        text = "return the one gradient itself, not a tuple that contains it"
        raise Mismatch(calling.COUNT, "the pullback", text)
    if isinstance(pulled, list):
        text = "the pullback returns a list, expected a tuple of gradients"
        raise Mismatch(calling.TYPE, "the pullback", text)
    names = [f"the gradient for {name}" for name in operation.differentiated]
    named = dict(zip(names, gradients, strict=True))
    arrays = named if isinstance(value, float) else {**named, "the value": value}
    for what, result in arrays.items():
        calling.require_array(what, result)
    return {"the value": value, **named}


def inputs_of(operation: Operation, implementation: Callable, case: Case) -> dict[str, object]:
    """The arguments of a case, and an upstream gradient for the value that is returned."""
    arguments = operation.arguments(case)
    value, _ = implementation(*copies(arguments))
    return {**arguments, THE_UPSTREAM: drawn_upstream(case, value)}


def results(operation: Operation, implementation: Callable, given: list) -> dict:
    """The value and the gradients of one call, by name; the upstream gradient is given last."""
    *arguments, dy = given
    value, pullback = implementation(*arguments)
    return by_name(operation, value, pullback(dy))


def right_results(operation: Operation, case: Case) -> tuple[dict, dict]:
    """The inputs of a case, and the definition's value and gradients."""
    inputs = operation.arguments(case)
    value, pullback = operation.reference(*copies(inputs))
    inputs[THE_UPSTREAM] = drawn_upstream(case, value)
    return inputs, by_name(operation, value, pullback(copied(inputs[THE_UPSTREAM])))


def drawn_upstream(case: Case, value: np.ndarray) -> np.ndarray | float:
    """An upstream gradient for a value, of the case's class; never all ones if ordinary.

    That of a number is a Python number, which leaves float32 arrays float32.
    """
    rng = np.random.default_rng([case.seed, 1])
    kind = case.get("upstream")
    if not np.shape(value):
        return NUMBERS.get(kind, float(rng.uniform(1.5, 2.5)))
    change = ARRAYS.get(kind, lambda rng, dy: dy * NUMBERS.get(kind, 1))
    dy = change(rng, spread(rng, np.shape(value)))
    return dy.astype(np.float32) if np.asarray(value).dtype == np.float32 else dy


def copied(dy: np.ndarray | float) -> np.ndarray | float:
    """An upstream gradient that the pullback may overwrite."""
    return dy.copy() if isinstance(dy, np.ndarray) else dy


def copies(arguments: Mapping[str, object], layout: Callable = np.ndarray.copy) -> list:
    """The arguments in the order of the call, their arrays copied, in a memory layout.

    An array that occurs twice remains one array.
    """
    made = {id(a): layout(a) for a in arguments.values() if isinstance(a, np.ndarray)}
    return [made.get(id(a), a) for a in arguments.values()]


def rounding(case: Case, inputs: Mapping[str, object]) -> float:
    """The tolerance: EXACT, or more with a huge state, which multiplies the rounding of 1 - z.

    With a bound near 1 it is more as well: y² is rounded before it is subtracted from 1.
    """
    huge = case.get("state") == "huge"
    largest = max(np.max(np.abs(array)) for array in [*inputs.values()][:-1]) if huge else 1.0
    bound = inputs.get("bound", 0.0)
    return max(EXACT * largest, 8 * np.finfo(float).eps / (1 - bound))


def compared(operation: Operation, implementation: Callable, case: Case) -> Pairs:
    """Compare all results with the definition's, and the arguments with their copies."""
    inputs, right = right_results(operation, case)
    given = copies(inputs)
    allowed = rounding(case, inputs)
    for what, result in results(operation, implementation, given).items():
        both = (operation.alike(inputs, one) for one in (result, right[what]))
        yield Pair(what, *both, allowed, operation.floor_of(inputs[THE_UPSTREAM]))
    yield from unaltered(given, inputs)


def unaltered(given: Iterable, before: Mapping[str, object], by: str = "function") -> Pairs:
    """The comparison of what a function was given with copies, by name."""
    for (name, was), after in zip(before.items(), given, strict=True):
        yield Pair(f"{name}, which the {by} must not alter,", 1 * after, 1 * was, 0, None, ALTERED)
