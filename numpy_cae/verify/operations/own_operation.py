"""`properties_of`: the properties of an operation of one's own, and their tests in pytest."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from numpy_cae.verify.checks.call import is_pair
from numpy_cae.verify.operations.case import VALUES
from numpy_cae.verify.operations.operation import (
    CLASSES,
    Operation,
    Values,
    arguments_of,
    leading_axes,
    simplest_case,
    with_each_array,
)
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shared_properties import shared_properties

SIZES = (1, 2, 3, 4, 5, 8, 33)
"""The options of a size that the caller does not state."""
SMOOTH = {"values": tuple(v for v in VALUES if v not in ("near ties", "tiny", "mixed", "wide"))}
"""Classes of values where differences are a good derivative: not beside kinks, nor where entries
are tiny or of very different size."""


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
    text = " ".join(shapes.values())
    leading = leading_axes(shapes)
    names = text.replace("...", " ".join(leading)).replace("*", " ").split()
    drawn_sizes = {size: SIZES for size in names if not size.isdigit()}
    unknown = {*(sizes or ()), *(values or ()), *(differentiable or ())} - {*shapes, *drawn_sizes}
    if unknown:
        only = ", ".join(shapes)
        raise ValueError(f"{name}: shapes has no {', '.join(sorted(unknown))}, only {only}")
    if "..." in text:
        is_alone = set(shapes.values()) == {"..."}
        drawn_sizes["axes"] = (3, 4, 2, 1) if is_alone else (2, *range(len(leading) + 1))
    arguments = arguments_of(shapes, {**dict.fromkeys(shapes, (-2.0, 2.0)), **(values or {})})
    every = with_each_array({**drawn_sizes, **CLASSES, **(sizes or {})}, arguments)
    example = arguments(simplest_case(every))
    if differentiable is None:
        differentiable = [name for name, array in example.items() if array.dtype.kind == "f"]
    smooth = {"without_ties": SMOOTH, "saturates": True}
    operation = Operation(name, every, arguments, tuple(differentiable), **smooth)
    if definition is not None:
        which = "reference" if is_pair(definition(*example.values())) else "definition"
        operation = replace(operation, **{which: definition})
    return tuple(shared_properties(operation))


def operation_test(
    shapes: Mapping[str, str], definition: Callable | None = None, **options
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
    6
    """

    def with_properties(f: Callable) -> Callable:
        f.operation_test = properties_of(f, shapes, definition, **options)  # type: ignore[attr-defined]
        f.operation_arrays = tuple(shapes)  # type: ignore[attr-defined]
        return f

    return with_properties
