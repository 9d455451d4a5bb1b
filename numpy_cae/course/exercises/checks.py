"""Checks of an exercise's function: those that only it has, and those that recur.

An argument is a number, an array, a dict of arrays by name, a list of arrays, or a list of the
pairs (w, b) of each layer.
"""

from collections.abc import Callable
from copy import deepcopy
from inspect import signature

import numpy as np

from numpy_cae.verify.checks.call import leaves, require_shape
from numpy_cae.verify.checks.mismatch import ALTERED, COUNT, Mismatch
from numpy_cae.verify.operations.property import require_equal

Check = Callable[..., None]
CHECKS: dict[tuple[str, str], Check] = {}
"""CHECKS: the checks that only one exercise has, by the names of the exercise and the property."""


def checks(exercise: str, name: str, copied: bool = True) -> Callable[[Check], Check]:
    """Register the check that is decorated, of a property of an exercise.

    The check is called with the function, the case, and the arguments of the case by name. If
    `copied`, the function gets copies of what the check passes to it.
    """

    def registered(check: Check) -> Check:
        CHECKS[exercise, name] = on_copies(check) if copied else check
        return check

    return registered


def on_copies(check: Check) -> Check:
    """The check of a function that gets copies of its arguments."""

    def with_copies(function: Callable, case, **given: object) -> None:
        check(lambda *passed: function(*map(deepcopy, passed)), case, **given)

    return with_copies


def purity(function, case, **given):
    """The property of every exercise whose arguments are arrays."""
    before = deepcopy(given)
    function(*given.values())
    for name, argument in before.items():
        after = dict(leaves(name, given[name]))
        for part, array in leaves(name, argument):
            if isinstance(array, np.ndarray) and not np.array_equal(after[part], array):
                raise Mismatch(ALTERED, part, f"the call changes {part}")


class Recorded:
    """A function among the arguments of an exercise, made of the text that a report prints for it.

    `calls` has the arguments and, last, the result of each call, as they were at that time.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.function = eval(text, {"np": np})
        self.calls = []

    def __call__(self, *arguments, **named):
        arguments = signature(self.function).bind(*arguments, **named).args
        result = self.function(*arguments)
        self.calls.append(deepcopy((*arguments, result)))
        return result

    def __deepcopy__(self, memo) -> "Recorded":
        return self  # a check reads the calls of the student's function

    def __repr__(self) -> str:
        return self.text


def same_as(definition: Callable, names: tuple[str, ...] = (), part=None) -> Check:
    """A check that a function returns what a definition returns: an array, a number or a list of
    arrays, which has one name, or a tuple of these.

    `part` says what alone is compared: the name of one of several results, or the first column of
    an array and the end of the columns.
    """

    def check(function: Callable, case, **given: object) -> None:
        returned = function(*given.values())
        expected = definition(*map(deepcopy, given.values()))
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

    return check


def require_same(returned, expected, names: tuple[str, ...] = ()) -> None:
    """Raise unless a result equals the expected one, part by part if that is a tuple.

    A TypeError says that something else is returned than it has to be.
    """
    if not isinstance(expected, tuple):
        returned = (returned,)
        expected = (expected,)
        names = names[:1] or ("the value",)
    names = names or tuple(f"value {number}" for number in range(len(expected)))
    require_parts(returned, names[: len(expected)])
    for name, one, other in zip(names, returned, expected, strict=False):
        if isinstance(other, list):
            parts = tuple(f"{name}[{number}]" for number in range(len(other)))
            require_same(tuple(require_parts(one, parts)), tuple(other), parts)
            continue
        if one is None:
            raise TypeError(f"{name} is None: is a return missing?")
        if np.asarray(one).dtype.kind not in "biuf":
            raise TypeError(f"{name} is {type(one).__name__}, expected numbers")
        require_equal(name, one, other)


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
