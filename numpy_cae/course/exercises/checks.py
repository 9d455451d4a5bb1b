"""Checks of an exercise's function that recur; `own_checks` has those of single exercises.

An argument is a number, an array, a dict of arrays by name, a list of arrays, or a list of the
pairs (w, b) of each layer.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from functools import partial
from inspect import signature
from typing import Any

import numpy as np

from numpy_cae.verify.checks.calls import gradients_of_leaves
from numpy_cae.verify.checks.gradients import find_wrong_gradients
from numpy_cae.verify.checks.leaves import all_leaves, leaves, rebuild
from numpy_cae.verify.checks.mismatch import (
    ALTERED,
    COUNT,
    DTYPE,
    NUMBER,
    OVERWRITTEN,
    REPEATED,
    Mismatch,
    has_dtype,
    require_array,
    require_shape,
)
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.compare import require_equal
from numpy_cae.verify.operations.diagnosis import same
from numpy_cae.verify.operations.upstream import draw_upstream
from numpy_cae.verify.operations.values import LAYOUTS

Names = tuple[str, ...]
Part = str | Sequence[int] | None
"""The one of several results that a property is about, or the first and the end of its columns."""

PULLBACK = "the pullback"
AGREES = "it agrees with central differences of the function that you wrote"
"""The statement of each gradient's property."""
KEY = re.compile(r"\w+\['(\w+)'\]")
"""The name of an array in a dict, such as weights['w'], whose key is w."""


def on_copies(check: Callable) -> Callable:
    """The check of a function that gets copies of its arguments."""

    def with_copies(function: Callable, case, **arguments: object) -> None:
        check(lambda *passed: function(*map(deepcopy, passed)), case, **arguments)

    return with_copies


def purity(draw, function, case, **arguments):
    """The property of every exercise whose arguments are arrays."""
    before = all_leaves(deepcopy([*arguments.values()]), [*arguments])
    function(*arguments.values())
    after = all_leaves([*arguments.values()], [*arguments])
    for (part, array), (_, now) in zip(before, after, strict=True):
        if isinstance(array, np.ndarray) and not np.array_equal(now, array):
            raise Mismatch(ALTERED, part, f"the call changes {part}")


def strides(draw, function, case, **arguments):
    """The property that the memory order of the arguments does not matter."""
    expected = arrays_in(function(*deepcopy(arguments).values()), case)
    returned = function(*_changed(arguments, LAYOUTS[case.get("layout")]))
    if not same(arrays_in(returned, case), expected):
        text = f"of arrays {case.get('layout')}, it returns something else than of copies of them"
        raise Mismatch(NUMBER, "the result", text)


def dtype(draw, function, case, **arguments):
    """The property that float32 stays float32, of what has a dtype to lose (`has_dtype`)."""
    narrowed = _changed(arguments, lambda a: a.astype(np.float32) if a.dtype == np.float64 else a)
    for result in numbers_in(function(*narrowed), case):
        is_double = getattr(result, "dtype", None) == np.float64
        if is_double and not has_dtype(result, np.float32):
            raise Mismatch(DTYPE, "the result", "given float32, a result is float64")


def independence(draw, function, case, **arguments):
    """The property that no call depends on another; `draw` draws those of another call."""
    first = function(*deepcopy(arguments).values())
    before = arrays_in(first, case)
    function(*draw(Case(case.sizes, case.seed + 1)).values())
    if not same(arrays_in(first, case), before):
        text = "after another call, what the first one returned is another"
        raise Mismatch(OVERWRITTEN, "the result", text)
    if not same(arrays_in(function(*deepcopy(arguments).values()), case), before):
        text = "called again after a call with other arguments, it returns something else"
        raise Mismatch(REPEATED, "the result", text)


def _changed(arguments: Mapping[str, object], change: Callable) -> Iterator[object]:
    """The arguments with every array changed."""
    for name, argument in arguments.items():
        parts = (change(p) if isinstance(p, np.ndarray) else p for _, p in leaves(name, argument))
        yield rebuild(argument, parts)


class Recorded:
    """A function among the arguments of an exercise, made of the text that a report prints for it.

    `calls` has the arguments and, last, the result of each call, as they were at that time.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.function = eval(text, {"np": np})
        self.calls: list[tuple] = []

    def __call__(self, *arguments, **named):
        arguments = signature(self.function).bind(*arguments, **named).args
        result = self.function(*arguments)
        self.calls.append(deepcopy((*arguments, result)))
        return result

    def __deepcopy__(self, memo) -> "Recorded":
        return self  # a check reads the calls of the student's function

    def __repr__(self) -> str:
        return self.text


def agrees(
    definition: Callable, names: Names, part: Part, function: Callable, case: Case, **arguments
) -> None:
    """The property that a function returns what a definition returns: an array, a number or a list
    of arrays, which has one name, or a tuple of these.

    `part` says what alone is compared: the name of one of several results, or the first column of
    an array and the end of the columns.
    """
    returned = function(*arguments.values())
    expected = definition(*map(deepcopy, arguments.values()))
    if isinstance(part, str):
        number = names.index(part)
        returned = require_parts(returned, names)[number]
        require_same(returned, expected[number], (part,))
    elif part:
        require_shape(names[0], np.asarray(returned), expected.shape)
        columns = slice(*part)
        require_same(np.asarray(returned)[:, columns], expected[:, columns], names)
    else:
        require_same(returned, expected, names)


def require_same(returned, expected, names: tuple[str, ...] = ()) -> None:
    """Raise unless a result equals the expected one, part by part if that is a tuple.

    A TypeError says that something else is returned than it has to be.
    """
    name = next(iter(names), "the value")
    if isinstance(expected, list | tuple):
        if isinstance(expected, list):
            names = tuple(f"{name}[{number}]" for number in range(len(expected)))
        names = names or tuple(f"value {number}" for number in range(len(expected)))
        require_parts(returned, names[: len(expected)])
        for part, result, right in zip(names, returned, expected, strict=False):
            require_same(result, right, (part,))
        return
    if returned is None:
        raise TypeError(f"{name} is None: is a return missing?")
    if np.asarray(returned).dtype.kind not in "biuf":
        raise TypeError(f"{name} is {type(returned).__name__}, expected numbers")
    require_equal(name, returned, expected)


def require_parts(returned, names) -> tuple | list:
    """What a function returned; a TypeError if it is no tuple or list with a thing for each name.

    Another number of things is an AssertionError: there may be a known mistake behind it.
    """
    if isinstance(returned, tuple | list) and len(returned) == len(names):
        return returned
    expected = f"expected {len(names)}: {', '.join(names)}"
    if isinstance(returned, tuple | list):
        count = f"the number of things that it returns is {len(returned)}"
        raise Mismatch(COUNT, "the number of things", f"{count}, {expected}")
    raise TypeError(f"it returns {type(returned).__name__}, {expected}")


def arrays_in(thing: object, case: Case) -> list[np.ndarray]:
    """Copies of the arrays and numbers in a thing."""
    return [np.copy(number) for number in numbers_in(thing, case)]


def numbers_in(thing: Any, case: Case) -> Iterator[Any]:
    """The arrays and numbers in a thing, those that a pullback returns, and a recorder's calls."""
    if hasattr(thing, "calls"):
        yield from numbers_in(thing.calls, case)
    elif isinstance(thing, dict):
        yield from numbers_in([thing[name] for name in sorted(thing)], case)
    elif isinstance(thing, tuple) and len(thing) == 2 and callable(thing[1]):
        yield from numbers_in(thing[0], case)
        yield from numbers_in(thing[1](draw_upstream(case, thing[0])), case)
    elif isinstance(thing, list | tuple):
        for part in thing:
            yield from numbers_in(part, case)
    elif isinstance(thing, np.ndarray | np.generic | float | int):
        yield thing


def gradients_agree(
    definition: Callable,
    inputs: Names,
    returns: Names,
    only: Names,
    function: Callable,
    case: Case,
    **arguments,
) -> None:
    """The property that gradients agree with differences of the function's own value.

    Where differences do not decide, a function with the value of the definition needs its
    gradients.

    `inputs` are the arguments that get a gradient, in the order of the gradients. `returns` names
    the things that the function returns, the value first. The second one is `PULLBACK`, or the
    others are the gradients of a scalar value. `only` names the arrays, none being all.
    """

    values = [arguments[name] for name in inputs]
    names = [name for name, _ in all_leaves(values, inputs)]
    chosen = [name for name in names if not only or KEY.sub(r"\1", name) in only]
    if not case.is_plain:
        _require_gradients(definition, inputs, returns, chosen, function, case, arguments)
        return
    problems = find_wrong_gradients(
        _with_pullback(function, arguments, inputs, returns),
        values,
        inputs,
        case.rng(),
        only=chosen,
        kinks_excused=1.0,  # sums may tie in the pooling
    )
    function(*arguments.values())  # the call that a report shows
    if problems:
        first, *more = problems
        also = [f"also: {problem.subject}" for problem in more]
        raise Mismatch(first.kind, first.subject, "\n".join([str(first), *also]))


def _require_gradients(
    definition: Callable,
    inputs: Names,
    returns: Names,
    chosen: Sequence[str],
    function: Callable,
    case: Case,
    arguments: Mapping[str, object],
) -> None:
    """Raise unless a function with the value of a definition has its gradients."""
    values = [arguments[name] for name in inputs]
    value, pullback = _with_pullback(function, arguments, inputs, returns)(*values)
    right, right_pullback = _with_pullback(definition, arguments, inputs, returns)(*values)
    if not same([np.asarray(value)], [np.asarray(right)]):
        return
    dy = draw_upstream(case, right)
    gradients = gradients_of_leaves(values, inputs, pullback(dy))
    right_gradients = gradients_of_leaves(values, inputs, right_pullback(dy))
    names = [name for name, _ in all_leaves(values, inputs)]
    for name, gradient, expected in zip(names, gradients, right_gradients, strict=True):
        if name in chosen and expected is not None:
            require_array(f"the gradient for {name}", gradient)
            require_equal(f"the gradient for {name}", gradient, expected)


def _with_pullback(
    function: Callable, arguments: Mapping[str, object], inputs: Names, returns: Names
) -> Callable:
    """The function of the inputs alone, which returns its value and a pullback."""

    def f(*values):
        changed = dict(zip(inputs, values, strict=True))
        value, *results = _call(function, {**arguments, **changed}, returns)
        if PULLBACK in returns:
            pullback = results[0]
        else:
            pullback = partial(_scale, results)
        return value if np.ndim(value) else np.float64(value), pullback

    return f


def _scale(gradients: list, upstream: float) -> object:
    """The gradients of a scalar value, multiplied by the upstream gradient."""
    parts = [part for _, part in leaves("", gradients)]
    scaled = [None if part is None else upstream * part for part in parts]
    return rebuild(gradients, iter(scaled))


def upstream_is_one(returns: Names, function, case, **arguments) -> None:
    """The property that without an upstream gradient it is 1."""
    _, pullback = _call(function, arguments, returns)
    require_same(pullback(), pullback(1.0), ("the gradient without an argument",))


def _call(function: Callable, arguments: Mapping[str, object], returns: Names) -> list:
    """What a function returned; a TypeError unless it is what `returns` names."""
    returned = require_parts(function(*arguments.values()), returns)
    if PULLBACK in returns and not callable(returned[1]):
        raise TypeError(f"it does not return {' and '.join(returns)}")
    return list(returned)
