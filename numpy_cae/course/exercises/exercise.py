"""An exercise of a lesson: the function a student writes, what must hold of it, and a hint.

Most exercises are operations and are held to the properties of `catalogue`. The others (forward
kinematics, the features, a step of descent, ...) state their own, in the same form, so that they
are drawn, shrunk, reported and graded alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from numpy_cae import ops
from numpy_cae.verify.case import Case
from numpy_cae.verify.catalogue import properties_of
from numpy_cae.verify.operation import OPERATIONS, Operation, Sizes
from numpy_cae.verify.operation_properties import operation_properties
from numpy_cae.verify.property import EXAMPLES, Property, require_equal, shared_properties

Arguments = Callable[[Case], dict[str, object]]
Check = Callable[[Callable, Case], None]


@dataclass(frozen=True)
class Claim:
    """One sentence about an exercise's function, and the check that raises where it is untrue."""

    name: str
    statement: str
    check: Check
    points: int = 1
    hint: str = ""
    sizes: Sizes = field(default_factory=dict)  # in place of the exercise's own
    examples: int = EXAMPLES


@dataclass(frozen=True)
class Exercise:
    """What a student writes in one cell.

    Parameters
    ----------
    name : str
        Of the function, and the cell's grade_id.
    hint : str
        For whoever is stuck, in a sentence or two; not the answer.
    solution : callable
        The package's own, which later cells fall back on.
    properties : tuple of Property
    given : tuple of str
        Functions of earlier lessons that a solution may call: operations, or other exercises.
    """

    name: str
    hint: str
    solution: Callable = field(repr=False)
    properties: tuple[Property, ...] = field(repr=False)
    given: tuple[str, ...] = ()

    @property
    def points(self) -> int:
        return sum(prop.points for prop in self.properties)


def operation_exercise(
    operation: str | Operation,
    hint: str,
    solution: Callable | None = None,
    hints: Mapping[str, str] | None = None,
    given: tuple[str, ...] = (),
) -> Exercise:
    """An exercise in the form of `numpy_cae.ops`: a function that returns value and pullback.

    Parameters
    ----------
    operation : str or Operation
        One of the catalogue by its name, or one that the lesson alone has.
    hint : str
    solution : callable, optional
        By default the function of this name in `numpy_cae.ops`.
    hints : mapping of property name to str, optional
        What to think about where that property fails.
    given : tuple of str, optional
        As `Exercise` has it.
    """
    if isinstance(operation, str):
        operation = OPERATIONS[operation]
    if operation.name in OPERATIONS:
        stated: Iterable[Property] = properties_of(operation.name)
    else:
        stated = (*shared_properties(operation), *operation_properties(operation))
    hints = hints or {}
    hinted = tuple(replace(prop, hint=hints.get(prop.name, "")) for prop in stated)
    return Exercise(operation.name, hint, solution or getattr(ops, operation.name), hinted, given)


def exercise(
    name: str,
    hint: str,
    solution: Callable,
    arguments: Arguments,
    sizes: Sizes,
    claims: Iterable[Claim],
    given: tuple[str, ...] = (),
) -> Exercise:
    """An exercise that is no operation, held to claims of its own.

    Parameters
    ----------
    name, hint, solution, given
        As `Exercise` has them.
    arguments : callable
        A case to the arguments by name, in the order of the call; what a counterexample prints.
    sizes : mapping of str to tuple of int
        What hypothesis draws a case from, the simplest first.
    claims : iterable of Claim
    """
    properties = tuple(
        Property(
            name,
            claim.name,
            claim.statement,
            claim.check,
            arguments,
            {**sizes, **claim.sizes},
            claim.points,
            claim.hint,
            claim.examples,
        )
        for claim in claims
    )
    return Exercise(name, hint, solution, properties, given)


def same_as(definition: Callable, arguments: Arguments, names: tuple[str, ...] = ()) -> Check:
    """A check that a function returns what a definition returns.

    Parameters
    ----------
    definition : callable
        With the function's arguments; returns an array, a number, or a tuple of these.
    arguments : callable
        As the exercise has it.
    names : tuple of str, optional
        What the parts of a tuple are called; of a single result, one name.
    """

    def check(function: Callable, case: Case) -> None:
        expected = definition(*copies(arguments(case)))
        found = function(*copies(arguments(case)))
        require_same(found, expected, names)

    return check


def unaltered(arguments: Arguments) -> Claim:
    """The claim that a function leaves its arguments as they were."""

    def check(function: Callable, case: Case) -> None:
        before, given = arguments(case), copies(arguments(case))
        function(*given)
        for (name, kept), now in zip(before.items(), given, strict=True):
            if isinstance(kept, np.ndarray) and not np.array_equal(kept, now):
                raise AssertionError(f"the call alters {name}")

    return Claim("purity", "no argument is altered", check)


def require_same(found, expected, names: tuple[str, ...] = ()) -> None:
    """Raise unless a result equals the expected one, part by part where that is a tuple."""
    if not isinstance(expected, tuple):
        _require_number(found, names[0] if names else "the value")
        require_equal(names[0] if names else "the value", found, expected)
        return
    if not isinstance(found, tuple | list) or len(found) != len(expected):
        what = f"{len(found)} values" if isinstance(found, tuple | list) else type(found).__name__
        wanted = ", ".join(names) if names else f"{len(expected)} values"
        raise AssertionError(f"it returns {what}, expected {wanted}")
    for place, (one, other) in enumerate(zip(found, expected, strict=True)):
        name = names[place] if names else f"value {place}"
        _require_number(one, name)
        require_equal(name, one, other)


def _require_number(found, name: str) -> None:
    if found is None:
        raise AssertionError(f"{name} is None: is a return missing?")
    if np.asarray(found).dtype.kind not in "biuf":
        raise AssertionError(f"{name} is {type(found).__name__}, expected numbers")


def copies(arguments: Mapping[str, object]) -> list:
    """The arguments in the order of the call, arrays copied."""
    return [a.copy() if isinstance(a, np.ndarray) else a for a in arguments.values()]
