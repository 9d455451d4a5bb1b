"""`CATALOGUE`: the operations of `numpy_cae.ops` and the tied layer, with their properties.

`example` returns the arguments of a counterexample, which a report prints as a call.

`numpy_cae.course.catalogue` has a larger `CATALOGUE`, which contains the exercises of the lessons.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from numpy_cae.verify.operations.case import Case, Option
from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.patch import definition_of
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.results import right_results
from numpy_cae.verify.operations.shared_properties import LARGEST, own_properties, shared_properties
from numpy_cae.verify.operations.upstream import THE_UPSTREAM, Upstream
from numpy_cae.verify.operations.values import ORDINARY


@dataclass(frozen=True)
class Exercise:
    """A function to be written, and the properties that an implementation is tested for."""

    name: str
    solution: Callable = field(repr=False)  # the project's implementation
    properties: tuple[Property, ...] = field(repr=False)
    hint: str = ""  # shown where a property does not hold
    provided: tuple[str, ...] = ()  # names that an implementation may call without defining them

    @property
    def points(self) -> int:
        return round(sum(property_.points for property_ in self.properties))


def properties_of_operation(name: str) -> tuple[Property, ...]:
    """Every property of an operation."""
    operation = OPERATIONS[name]
    properties = [*shared_properties(operation), *own_properties(operation)]
    return tuple(
        sorted(properties, key=lambda property_: property_.name == LARGEST)
    )  # it takes longest


CATALOGUE: dict[str, Exercise] = {
    name: Exercise(name, definition_of(name), properties_of_operation(name)) for name in OPERATIONS
}


def find_exercise(name: str | Exercise, catalogue: Mapping[str, Exercise] = CATALOGUE) -> Exercise:
    """The exercise of this name, or the one itself; raise a ValueError that lists the names."""
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
    >>> for property_ in verify.properties("max_pool")[:3]:
    ...     print(f"{property_.name}: {property_.statement}")
    value: the value is that of the definition, loop by loop
    gradient for x: the pullback's gradient for x is that of the definition
    linearity: the pullback is linear: for 2 dy - 3 dy' it returns 2 and -3 times that of each
    """
    return find_exercise(name).properties


@dataclass(frozen=True, eq=False)
class Example:
    """The arguments of a case and, for an operation, the right results."""

    arguments: dict[str, Any]
    upstream: Upstream | None = None
    value: Any = None
    gradients: dict[str, Any] = field(default_factory=dict)


def example(name: str | Exercise | Property | Callable, seed: int, **sizes: Option) -> Example:
    """The arguments of a counterexample: a report prints the call of this function.

    Parameters
    ----------
    name : str, Exercise, Property or callable
        An operation of `numpy_cae.ops`, "tied_layer", an exercise, a property of an operation of
        one's own, or a function that `operation_test` has marked.
    seed : int
    **sizes : int or str
        The sizes of the arrays, such as frames=2, and classes such as values="ties".

    Returns
    -------
    Example
        With `arguments` by name and, for an operation, the `upstream` gradient and the `value` and
        `gradients` of the definition.

    Raises
    ------
    ValueError
        If there is no such operation, or a size is missing or unknown.

    Examples
    --------
    >>> from numpy_cae import verify
    >>> case = verify.example("max_pool", seed=0, batch=1, frames=2, channels=1, values="ties")
    >>> case.arguments["x"].ravel().tolist(), case.value.ravel().tolist()
    ([2.0, 1.0], [2.0])
    """
    properties = _properties_named(name)
    case = _case_of(properties, seed, sizes)
    arguments = properties[0].arguments(case)
    operation = properties[0].definition
    if operation is None:
        return Example(arguments)
    inputs, right = right_results(operation, case)
    value, *gradients = right.values()
    named = dict(zip(operation.differentiated, gradients, strict=True))
    return Example(arguments, inputs[THE_UPSTREAM], value, named)


def _properties_named(name: str | Exercise | Property | Callable) -> tuple[Property, ...]:
    """The properties of what `example` is called with."""
    if isinstance(name, Property):
        return (name,)
    if isinstance(name, str | Exercise):
        return find_exercise(name).properties
    return name.operation_test  # type: ignore[attr-defined]


def _case_of(properties: Sequence[Property], seed: int, sizes: Mapping[str, Option]) -> Case:
    """A case of an operation's properties; a ValueError if a size is missing or unknown."""
    allowed: dict[str, list] = {}
    for property_ in properties:
        for name, options in property_.sizes.items():
            allowed.setdefault(name, []).extend(options)
    needed = {name for name, options in allowed.items() if ORDINARY not in options}
    if not needed <= sizes.keys() <= allowed.keys():
        text = f"{', '.join(allowed)}, got {', '.join(sizes)}"
        raise ValueError(f"{properties[0].operation} has the sizes {text}")
    unknown = []
    for name, size in sizes.items():
        if isinstance(size, str) and size not in allowed[name]:
            unknown.append(size)
    if unknown:
        raise ValueError(f"{properties[0].operation} is not tried with {', '.join(unknown)}")
    return Case(tuple(sizes.items()), seed)


def example_call(property_: Property, case: Case) -> str:
    """The call of `verify.example` that returns a case of a property."""
    name = property_.example_of or f'"{property_.operation}"'
    sizes = [f"{size_name}={size!r}" for size_name, size in case.sizes if size != ORDINARY]
    return f"example({name}, {', '.join(sizes)}, seed={case.seed})"
