"""`properties_of`: the properties of an operation of one's own, and their tests in pytest."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.verify.checks.call import is_pair
from numpy_cae.verify.operations import operation as drawing
from numpy_cae.verify.operations.case import VALUES
from numpy_cae.verify.operations.operation import CLASSES, Operation, Values, names_in
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shared_properties import shared_properties

SIZES = (1, 2, 3, 4, 5, 7, 8, 15, 31, 32, 33, 62, 63, 64, 65)
"""SIZES: the numbers that a size is drawn from if the caller does not state them."""
SIZE = re.compile(r"[^\W\d]\w*|\d+|(?:\w+[*+])+\w+")
IN_USE = ("values", "of", "layout", "upstream", "axes", "state", "seed")
"""IN_USE: names of what a case has besides sizes."""
DTYPES = ("float64", "float32")
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
    skip: Sequence[str] = (),
    dtypes: Sequence[str] = DTYPES,
    marks: Mapping[str, object] | None = None,
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
    seed : int, optional
        Of the random cases.

    Returns
    -------
    tuple of Property

    Raises
    ------
    ValueError
        If `sizes`, `values` or `differentiable` name something that `shapes` does not have, if
        `skip` or `marks` name no property, or if a size cannot be read or has a name in use.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> def scaled(x, scale):
    ...     return scale * x, lambda dy: (scale * dy, np.sum(x * dy, axis=0) / len(x))
    >>> stated = verify.properties_of(scaled, {"x": "batch channels", "scale": "channels"})
    >>> [each.name for each in stated][:3]
    ['gradient for x', 'gradient for scale', 'ties']
    >>> verify.check_property(stated[1], scaled)
    Traceback (most recent call last):
    AssertionError: the pullback's gradient for scale is that of central differences
        ...
    """
    name = getattr(f, "__name__", "the operation")
    shapes = {x: re.sub(r"\s*([*+])\s*", r"\1", text) for x, text in shapes.items()}
    _require_sizes(name, shapes)
    used = {*(sizes or ()), *(values or ()), *(differentiable or ())}
    known = [*shapes, *names_in(shapes), *drawing.leading_axes(shapes)]
    _require_known(name, "shapes", used, known)
    values = {**dict.fromkeys(shapes, (-2.0, 2.0)), **(values or {})}
    dtype = np.float32 if tuple(dtypes) == ("float32",) else np.float64
    arguments = drawing.arguments_of(shapes, values, dtype)
    every = drawing.with_each_array({**_drawn_sizes(shapes), **CLASSES, **(sizes or {})}, arguments)
    example = arguments(drawing.simplest_case(every))
    if differentiable is None:
        differentiable = [name for name, array in example.items() if array.dtype.kind == "f"]
    has_pullback = definition is not None and is_pair(definition(*example.values()))
    options = {"without_ties": SMOOTH, "saturates": True, "seeded_by": f"seed {seed}"}
    options["drawn_by_caller"] = tuple(x for x in values if callable(values[x]))
    options["reference" if has_pullback else "definition"] = definition
    operation = Operation(name, every, arguments, tuple(differentiable), **options)
    stated = tuple(shared_properties(operation))
    marks = marks or {}
    _require_known(name, "the list of properties", {*skip, *marks}, [each.name for each in stated])
    left_out = {*skip} if tuple(dtypes) == DTYPES else {*skip, "dtype"}
    marked = (replace(each, marks=marks.get(each.name, ()), example_of="stated") for each in stated)
    return tuple(each for each in marked if each.name not in left_out)


def _require_known(name: str, where: str, used: set[str], known: Sequence[str]) -> None:
    missing = ", ".join(sorted(used - {*known}))
    if missing:
        named = ", ".join(each for each in known if not each.isdigit())
        raise ValueError(f"{name}: {where} has no {missing}, only {named}")


def _require_sizes(name: str, shapes: Mapping[str, str]) -> None:
    """Raise a ValueError where a size is no name, number, product or sum, or its name is in use."""
    rule = f"a size is a name other than {', '.join(IN_USE)}, a number, a product, a sum, or ..."
    for argument, text in shapes.items():
        for size in text.split():
            if size != "..." and (not SIZE.fullmatch(size) or size in IN_USE):
                raise ValueError(f"{name}: {argument} has the size {size!r}; {rule}")


def _drawn_sizes(shapes: Mapping[str, str]) -> dict[str, tuple]:
    """The numbers to draw each size from, and how many axes "..." stands for."""
    leading = drawing.leading_axes(shapes) if "..." in " ".join(shapes.values()) else []
    names = [*names_in(shapes), *(name for name in leading if not name.isdigit())]
    drawn: dict[str, tuple] = dict.fromkeys(names, SIZES)
    if leading:
        is_alone = set(shapes.values()) == {"..."}
        drawn["axes"] = (3, 4, 2, 1) if is_alone else (2, *range(len(leading) + 1))
    return drawn


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
    7
    """

    def with_properties(f: Callable) -> Callable:
        stated = properties_of(f, shapes, definition, **options)
        named = (replace(each, example_of=f.__name__) for each in stated)
        f.operation_test = tuple(named)  # type: ignore[attr-defined]
        f.operation_arrays = tuple(shapes)  # type: ignore[attr-defined]
        return f

    return with_properties
