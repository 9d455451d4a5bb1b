"""`CATALOGUE`: the operations of `numpy_cae.ops` and the tied layer, with their properties.

`numpy_cae.course.catalogue` has a larger `CATALOGUE`, which contains the exercises of the lessons.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.patch import Patch, conventions_of, right_operation
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shared_properties import LARGEST, shared_properties
from numpy_cae.verify.operations.single_properties import single_properties

CONTRACT = "that of numpy_cae.ops"
"""The convention that an implementation follows unless another one is allowed."""


@dataclass(frozen=True)
class Exercise:
    """A function to be written, and the properties that an implementation is tested for."""

    name: str
    solution: Callable = field(repr=False)  # the project's implementation
    properties: tuple[Property, ...] = field(repr=False)
    hint: str = ""  # shown where a property does not hold
    given: tuple[str, ...] = ()  # names that an implementation may call without defining them
    convention: str = CONTRACT

    @property
    def points(self) -> int:
        return round(sum(stated.points for stated in self.properties))


def properties_of_operation(name: str, convention: Patch | None = None) -> tuple[Property, ...]:
    """Every property of an operation, or of the operation in another convention."""
    operation = OPERATIONS[name]
    only_ours = ""
    if convention is not None:
        operation = replace(operation, reference=convention.function())
        only_ours = convention.caught_by
    every = [*shared_properties(operation), *single_properties(operation)]
    every.sort(key=lambda stated: stated.name == LARGEST)  # what takes longest comes last
    return tuple(stated for stated in every if stated.name != only_ours)


def in_other_conventions(exercise: Exercise) -> Iterator[Exercise]:
    """The exercise in each documented convention other than the contract's."""
    for patch in conventions_of(exercise.name):
        stated = properties_of_operation(exercise.name, patch)
        yield replace(exercise, properties=stated, convention=patch.sentence)


CATALOGUE: dict[str, Exercise] = {
    name: Exercise(name, right_operation(name), properties_of_operation(name))
    for name in OPERATIONS
}


def find_exercise(name: str | Exercise, catalogue: Mapping[str, Exercise] = CATALOGUE) -> Exercise:
    """The exercise of this name, or the one given; raise a ValueError that lists the names."""
    if isinstance(name, Exercise):
        return name
    if name not in catalogue:
        raise ValueError(f"no operation is called {name!r}; there are {', '.join(catalogue)}")
    return catalogue[name]


def properties(name: str) -> tuple[Property, ...]:
    """What must hold of an operation: the properties that `report` tests for.

    Parameters
    ----------
    name : str
        An operation of `numpy_cae.ops`, or "tied_layer".

    Returns
    -------
    tuple of Property
        Each with a name, a statement and its points; `check_property` tests for one.

    Raises
    ------
    ValueError
        If there is no such operation; the message lists the names.

    Examples
    --------
    >>> from numpy_cae import verify
    >>> for stated in verify.properties("max_pool")[:3]:
    ...     print(f"{stated.name}: {stated.statement}")
    value: the value is that of the definition, loop by loop
    gradient for x: the pullback's gradient for x is that of the definition
    linearity: the pullback is linear: for 2 dy - 3 dy' it returns 2 and -3 times that of each
    """
    return find_exercise(name).properties
