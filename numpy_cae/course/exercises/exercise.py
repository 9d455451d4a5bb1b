"""An exercise of a lesson: the function that a student writes, its properties, and a hint.

Most exercises are operations and have the properties that `verify` states of them. The others
(forward kinematics, the features, a step of descent, ...) state their own, in the same form, so
that all are drawn, shrunk, reported and graded alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

from numpy_cae import ops
from numpy_cae.verify.case import Case
from numpy_cae.verify.catalogue import properties_of
from numpy_cae.verify.operation import OPERATIONS, Operation, Sizes
from numpy_cae.verify.operation_properties import operation_properties
from numpy_cae.verify.property import EXAMPLES, Property, shared_properties

Arguments = Callable[[Case], dict[str, object]]
Check = Callable[[Callable, Case], None]


@dataclass(frozen=True)
class Claim:
    """One sentence about an exercise's function, and the check that raises if it is false."""

    name: str
    statement: str
    check: Check
    points: int = 1
    sizes: Sizes = field(default_factory=dict)  # override those of the exercise
    examples: int = EXAMPLES


@dataclass(frozen=True)
class Exercise:
    """What a student writes in one cell.

    Parameters
    ----------
    name : str
        The name of the function, and the cell's grade_id.
    hint : str
        One or two sentences that help, without the answer.
    solution : callable
        The package's own, which later cells use where the student's fails.
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
        The name of an operation of `numpy_cae.ops`, or one that only the lesson has.
    hint : str
    solution : callable, optional
        By default the function of this name in `numpy_cae.ops`.
    hints : mapping of property name to str, optional
        A hint for each property, printed if it fails.
    given : tuple of str, optional
        As in `Exercise`.
    """
    if isinstance(operation, str):
        operation = OPERATIONS[operation]
    if operation.name in OPERATIONS:
        properties: Iterable[Property] = properties_of(operation.name)
    else:
        properties = (*shared_properties(operation), *operation_properties(operation))
    solution = solution or getattr(ops, operation.name)
    return Exercise(operation.name, hint, solution, _with_hints(properties, hints), given)


def exercise(
    name: str,
    hint: str,
    solution: Callable,
    arguments: Arguments,
    sizes: Sizes,
    claims: Iterable[Claim],
    hints: Mapping[str, str] | None = None,
    given: tuple[str, ...] = (),
) -> Exercise:
    """An exercise that is no operation, with properties of its own.

    Parameters
    ----------
    name, hint, solution, given
        As in `Exercise`.
    arguments : callable
        Makes the arguments from a case, by name, in the order of the call.
    sizes : mapping of str to tuple of int
        The sizes from which a case is drawn, the simplest first.
    claims : iterable of Claim
    hints : mapping of claim name to str, optional
        A hint for each claim, printed if it fails.
    """
    properties = (
        Property(
            name,
            claim.name,
            claim.statement,
            claim.check,
            arguments,
            {**sizes, **claim.sizes},
            claim.points,
            examples=claim.examples,
        )
        for claim in claims
    )
    return Exercise(name, hint, solution, _with_hints(properties, hints), given)


def _with_hints(
    properties: Iterable[Property], hints: Mapping[str, str] | None
) -> tuple[Property, ...]:
    hints = dict(hints or {})
    hinted = tuple(replace(prop, hint=hints.pop(prop.name, "")) for prop in properties)
    if hints:
        raise ValueError(f"hints for unknown properties: {', '.join(hints)}")
    return hinted
