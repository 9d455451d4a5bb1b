"""What may be tested under which name: `CATALOGUE`, the operations of `numpy_cae.ops` and the tied
layer.

Another module can have a larger `CATALOGUE`: that of `numpy_cae.course.catalogue` adds the
exercises of the lessons.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from numpy_cae.verify.checks.call import is_pair
from numpy_cae.verify.operations.operation import (
    OPERATIONS,
    Values,
    operation_of,
    simplest_case,
    sizes_in,
)
from numpy_cae.verify.operations.patch import Patch, conventions_of, right_operation
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shared_properties import shared_properties
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
    operation, only_ours = OPERATIONS[name], ""
    if convention is not None:
        operation = replace(operation, reference=convention.function())
        only_ours = convention.caught_by
    every = (*shared_properties(operation), *single_properties(operation))
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


def properties_of(
    f: Callable,
    shapes: Mapping[str, str],
    definition: Callable | None = None,
    *,
    sizes: Mapping[str, Sequence[int]] | None = None,
    values: Mapping[str, Values] | None = None,
    differentiable: Sequence[str] | None = None,
) -> tuple[Property, ...]:
    """What must hold of an operation of one's own: the properties that `numpy_cae.ops` has.

    These are the gradient for each argument, and that the pullback is linear, that float32 stays
    float32, that no argument is altered, that no call depends on another, and that the memory
    layout does not matter. `check_property` tests for one; `operation_test` makes tests of all.

    Parameters
    ----------
    f : (*arrays) -> (value, pullback)
        In the form of `numpy_cae.ops`, with one array or number as its value.
    shapes : mapping of str to str
        For each argument, in the order of the call, the sizes of its axes, such as "taps channels".
        Equal names are equal sizes. A size may also be a number, a product such as 2*frames, or
        "...": any number of axes.
    definition : callable, optional
        What f should compute: it returns the value alone, or a value and its pullback, with which
        all results of f are compared. Otherwise gradients are compared with differences of f.
    sizes : mapping of str to sequence of int, optional
        The numbers to draw a size from, the simplest first, such as {"taps": (1, 3, 5)}.
    values : mapping of str to (low, high) or callable, optional
        The range of an argument's numbers, by default (-2, 2), or a function that draws the
        argument: (rng, shape) -> array.
    differentiable : sequence of str, optional
        The arguments for which the pullback returns a gradient, by default all arrays of floats.

    Returns
    -------
    tuple of Property

    Raises
    ------
    ValueError
        If `sizes`, `values` or `differentiable` name something that `shapes` does not have.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> def scaled(x, scale):
    ...     return scale * x, lambda dy: (scale * dy, np.sum(x * dy, axis=0) / len(x))
    >>> stated = verify.properties_of(scaled, {"x": "batch channels", "scale": "channels"})
    >>> [each.name for each in stated][:3]
    ['gradient for x', 'gradient for scale', 'linearity']
    >>> verify.check_property(stated[1], scaled)
    Traceback (most recent call last):
    AssertionError: the pullback's gradient for scale is that of central differences
        ...
    """
    name = getattr(f, "__name__", "the operation")
    sizes, values = dict(sizes or {}), {**dict.fromkeys(shapes, (-2.0, 2.0)), **(values or {})}
    known = {*shapes, *sizes_in(shapes)}
    unknown = [one for one in (*values, *sizes, *(differentiable or ())) if one not in known]
    if unknown:
        raise ValueError(f"{name}: shapes has no {', '.join(unknown)}, only {', '.join(shapes)}")
    operation = operation_of(name, shapes, sizes, values, differentiable)
    if definition is not None:
        result = definition(*operation.arguments(simplest_case(operation.sizes)).values())
        which = "reference" if is_pair(result) else "definition"
        operation = replace(operation, **{which: definition})
    return tuple(shared_properties(operation))
