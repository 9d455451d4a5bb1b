"""Catalogues: what may be tested under which name, as data for tests, lessons and the grader.

`CATALOGUE` holds the operations of `numpy_cae.ops` and the tied layer. Another package can make a
larger one, such as `numpy_cae.course.catalogue`, which adds the exercises of the lessons.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.patch import Patch, conventions_of, right_operation
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shared_properties import shared_properties
from numpy_cae.verify.operations.single_properties import operation_properties

CONTRACT = "that of numpy_cae.ops"
"""The convention that an implementation follows unless another one is allowed."""


@dataclass(frozen=True)
class Task:
    """One function to be written, and the properties that it is tested for."""

    name: str
    solution: Callable = field(repr=False)  # the project's own implementation
    properties: tuple[Property, ...] = field(repr=False)
    hint: str = ""  # shown where a property does not hold
    given: tuple[str, ...] = ()  # names that an implementation may call without defining them
    convention: str = CONTRACT

    @property
    def points(self) -> int:
        return sum(stated.points for stated in self.properties)


Catalogue = Mapping[str, Task]


def properties_of(name: str, convention: Patch | None = None) -> tuple[Property, ...]:
    """Every property of an operation, or of one in another convention."""
    operation, only_ours = OPERATIONS[name], ""
    if convention is not None:
        operation = replace(operation, reference=convention.function())
        only_ours = convention.caught_by
    every = (*shared_properties(operation), *operation_properties(operation))
    return tuple(stated for stated in every if stated.name != only_ours)


def in_other_conventions(task: Task) -> Iterator[Task]:
    """The task in each documented convention other than the contract's."""
    for patch in conventions_of(task.name):
        stated = properties_of(task.name, patch)
        yield replace(task, properties=stated, convention=patch.sentence)


CATALOGUE: dict[str, Task] = {
    name: Task(name, right_operation(name), properties_of(name)) for name in OPERATIONS
}


def properties(name: str) -> tuple[Property, ...]:
    """The properties of an operation of `numpy_cae.ops` or of "tied_layer", else a ValueError."""
    return find_task(CATALOGUE, name).properties


def find_task(catalogue: Catalogue, name: str) -> Task:
    """The task of this name; if there is none, a ValueError that lists the names there are."""
    if name not in catalogue:
        raise ValueError(f"no operation is called {name!r}; there are {', '.join(catalogue)}")
    return catalogue[name]
