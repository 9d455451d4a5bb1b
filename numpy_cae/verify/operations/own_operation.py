"""`properties_of`: the properties of an operation of one's own, and their tests in pytest."""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from numpy_cae.verify.checks.calls import is_value_and_pullback
from numpy_cae.verify.operations.case import Sizes, simplest_case
from numpy_cae.verify.operations.empty_arrays import ANY_AXES, state_empty_arrays
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shapes import (
    Arguments,
    Values,
    add_choice_of_array,
    arguments_of,
    leading_axes,
    names_in,
)
from numpy_cae.verify.operations.shared_properties import shared_properties
from numpy_cae.verify.operations.values import VALUES

NOT_SMOOTH = ("near ties", "tiny", "mixed", "wide")
"""Classes of values where differences are no good derivative: beside kinks, or where entries are
tiny or of very different size."""


DTYPES = ("float64", "float32")
RANGE = (-2.0, 2.0)
"""The range of an argument's numbers if the caller does not state it."""


def properties_of(
    f: Callable,
    shapes: Mapping[str, str],
    definition: Callable | None = None,
    *,
    sizes: Mapping[str, Sequence[int]] | None = None,
    values: Mapping[str, Values] | None = None,
    differentiable: Sequence[str] | None = None,
    skip: Sequence[str] = (),
    dtypes: Sequence[str] = DTYPES,
    marks: Mapping[str, object] | None = None,
    linear: bool = False,
    cases: int | None = None,
    nondeterminism: float = 0.0,
    only: Sequence[str] = (),
    empty: Sequence[str] = (),
    seed: int = 0,
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
        Equal names are equal sizes. A size may also be a number, a product or sum such as 2*frames
        or in+out, or "...": any number of axes.
    definition : callable, optional
        What f should compute: it returns the value alone, or a value and its pullback, with which
        all results of f are compared. Otherwise gradients are compared with differences of f.
    sizes : mapping of str to sequence of int, optional
        The numbers to draw a size from, the simplest first, such as {"taps": (1, 3, 5)}.
    values : mapping of str to (low, high) or callable, optional
        The range of an argument's numbers, by default (-2, 2), or a function that draws the
        argument, perhaps as integers: (rng, shape) -> array. What it draws is never altered.
    differentiable : sequence of str, optional
        The arguments for which the pullback returns a gradient, by default all arrays of floats.
    skip : sequence of str, optional
        The names of properties that f need not have, such as "dtype".
    dtypes : sequence of str, optional
        By default ("float64", "float32"): each stays what it is. With ("float64",) there is no
        property "dtype"; with ("float32",) all arrays are float32.
    marks : mapping of str to a mark of pytest, or several, optional
        By property, such as {"dtype": pytest.mark.xfail}.
    linear : bool, optional
        Whether f is linear in each argument that gets a gradient: then there is a property "adjoint
        in ..." for each, the dot test <A x, dy> = <x, A' dy>, without differences.
    cases : int, optional
        Each property is tried on so many of its cases, small and large ones; by default on all.
    nondeterminism : float, optional
        By how much repeated results may differ, relative to the largest entry, as those of an
        iterative solver do; by default by rounding.
    only : sequence of str, optional
        The names of the properties to be returned, such as "gradient for x"; by default all.
    empty : sequence of str, optional
        The names of sizes that may be 0, such as "batch", each a property "empty in batch"; with
        "..." there may also be no axis in its place, a property "without axes".
    seed : int, optional
        Of the random cases.

    Returns
    -------
    tuple of Property

    Raises
    ------
    ValueError
        If `sizes`, `values`, `differentiable` or `empty` name something that `shapes` does not
        have, if `skip`, `only` or `marks` name no property, if a size cannot be read or has a name
        in use, or if `cases` is below 1.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> def scaled(x, scale):
    ...     return scale * x, lambda dy: (scale * dy, np.sum(x * dy, axis=0) / len(x))
    >>> properties = verify.properties_of(scaled, {"x": "batch channels", "scale": "channels"})
    >>> [property_.name for property_ in properties][:3]
    ['gradient for x', 'gradient for scale', 'ties']
    >>> verify.check_property(properties[1], scaled)
    Traceback (most recent call last):
    AssertionError: the pullback's gradient for scale is that of central differences
        ...
    """
    name = getattr(f, "__name__", "the operation")
    shapes = {x: re.sub(r"\s*([*+])\s*", r"\1", text) for x, text in shapes.items()}
    sizes = sizes or {}
    values = values or {}
    marks = marks or {}
    _require_sizes(name, shapes)
    known_names = [*shapes, *names_in(shapes), *leading_axes(shapes)]
    _require_known(name, "shapes", {*sizes, *values, *(differentiable or ())}, known_names)
    sizes_that_vary = names_in(shapes)
    if "..." in " ".join(shapes.values()):
        sizes_that_vary.append(ANY_AXES)
    _require_known(name, "shapes", {*empty}, sizes_that_vary)
    dtype = np.float32 if tuple(dtypes) == ("float32",) else np.float64
    arguments = arguments_of(shapes, {**dict.fromkeys(shapes, RANGE), **values}, dtype)
    all_sizes = {**_default_sizes(shapes), "values": tuple(VALUES), **_as_tuples(sizes)}
    operation = _own_operation(name, all_sizes, arguments, definition, differentiable)
    drawn_by_caller = tuple(argument for argument in values if callable(values[argument]))
    operation = replace(
        operation,
        seeded_by=f"seed {seed}",
        drawn_by_caller=drawn_by_caller,
        nondeterminism=nondeterminism,
        linear_in=operation.differentiated if linear else (),
    )
    properties = list(shared_properties(operation))
    properties += [state_empty_arrays(operation, size) for size in empty]
    property_names = [property_.name for property_ in properties]
    _require_known(name, "the list of properties", {*skip, *only, *marks}, property_names)
    left_out = {*skip} if tuple(dtypes) == DTYPES else {*skip, "dtype"}
    if only:
        left_out |= {*property_names} - {*only}
    if cases is not None and cases < 1:
        raise ValueError(f"{name}: cases is {cases}, expected at least 1")
    return tuple(
        replace(
            property_, marks=marks.get(property_.name, ()), example_of="property_", most_cases=cases
        )
        for property_ in properties
        if property_.name not in left_out
    )


SMOOTH = {"values": tuple(name for name in VALUES if name not in NOT_SMOOTH)}


def _own_operation(
    name: str,
    sizes: Sizes,
    arguments: Arguments,
    definition: Callable | None,
    differentiable: Sequence[str] | None,
) -> Operation:
    """The operation; a definition that returns a value and a pullback is its reference."""
    sizes = add_choice_of_array(sizes, arguments)
    example = arguments(simplest_case(sizes))
    if differentiable is None:
        differentiable = [x for x, array in example.items() if array.dtype.kind == "f"]
    operation = Operation(
        name, sizes, arguments, tuple(differentiable), saturates=True, without_ties=SMOOTH
    )
    if definition is None:
        return operation
    if is_value_and_pullback(definition(*example.values())):
        return replace(operation, reference=definition)
    return replace(operation, definition=definition)


def _require_known(name: str, where: str, used: set[str], known_names: Collection[str]) -> None:
    """Raise a ValueError if a name is used that is not known."""
    missing = ", ".join(sorted(used - {*known_names}))
    if missing:
        words = ", ".join(word for word in known_names if not word.isdigit())
        raise ValueError(f"{name}: {where} has no {missing}, only {words}")


SIZE = re.compile(r"[^\W\d]\w*|\d+|(?:\w+[*+])+\w+")
IN_USE = ("values", "of", "layout", "upstream", "axes", "state", "seed")
"""Names of what a case has besides sizes."""


def _require_sizes(name: str, shapes: Mapping[str, str]) -> None:
    """Raise a ValueError where a size is no name, number, product or sum, or its name is in use."""
    rule = f"a size is a name other than {', '.join(IN_USE)}, a number, a product, a sum, or ..."
    for argument, text in shapes.items():
        for size in text.split():
            if size != "..." and (not SIZE.fullmatch(size) or size in IN_USE):
                raise ValueError(f"{name}: {argument} has the size {size!r}; {rule}")


def _as_tuples(sizes: Mapping[str, Sequence[int]]) -> dict[str, tuple]:
    """The sizes that a caller states."""
    return {name: tuple(options) for name, options in sizes.items()}


SIZES = (1, 2, 3, 4, 5, 7, 8, 15, 31, 32, 33, 62, 63, 64, 65)
"""The numbers that a size is drawn from if the caller does not state them."""


def _default_sizes(shapes: Mapping[str, str]) -> dict[str, tuple]:
    """The numbers to draw each size from, and how many axes "..." stands for."""
    sizes: dict[str, tuple] = dict.fromkeys(names_in(shapes), SIZES)
    if "..." not in " ".join(shapes.values()):
        return sizes
    leading = leading_axes(shapes)
    for name in leading:
        if not name.isdigit():
            sizes[name] = SIZES
    is_alone = set(shapes.values()) == {"..."}
    sizes["axes"] = (3, 4, 2, 1) if is_alone else (2, *range(len(leading) + 1))
    return sizes


def operation_test(
    shapes: Mapping[str, str], definition: Callable | None = None, **options: Any
) -> Callable[[Callable], Callable]:
    """Make a test of each property of an operation, in a test file of pytest.

    The tests are collected by the plugin `numpy_cae.pytest_plugin`, which pytest finds where
    numpy_cae is installed. A test that fails shows what is wrong and the smallest counterexample
    with its seed.

    Parameters
    ----------
    shapes, definition, **options
        Those of `properties_of`.

    Returns
    -------
    callable
        A decorator of a function in the form of `numpy_cae.ops`; it returns the function itself.

    Raises
    ------
    ValueError
        As `properties_of` does.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> @verify.operation_test(shapes={"x": "..."})
    ... def test_square(x):
    ...     return x * x, lambda dy: 2 * x * dy
    >>> len(test_square.operation_test)
    7
    """

    def with_properties(f: Callable) -> Callable:
        properties = properties_of(f, shapes, definition, **options)
        named = tuple(replace(property_, example_of=f.__name__) for property_ in properties)
        f.operation_test = named  # type: ignore[attr-defined]
        f.operation_arrays = tuple(shapes)  # type: ignore[attr-defined]
        return f

    return with_properties
