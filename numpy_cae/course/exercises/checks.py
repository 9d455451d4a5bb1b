"""Properties of an exercise's function, and the checks that recur in the exercises.

An argument is a number, an array, a dict of arrays by name, a list of arrays, or a list of the
pairs (w, b) of each layer. Gradients have the structure of the argument that they belong to.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass
from inspect import signature

import numpy as np

from numpy_cae.verify.checks.gradients import wrong_gradients
from numpy_cae.verify.checks.leaves import all_leaves, gradients_of_leaves, leaves, rebuilt
from numpy_cae.verify.checks.mismatch import ALTERED, COUNT, DTYPE, Mismatch
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import Property, require_equal

Arguments = Callable[[Case], dict[str, object]]
Check = Callable[..., None]
PULLBACK = "the pullback"


def states(
    name: str, statement: str, copied: bool = True, **options
) -> Callable[[Check], Property]:
    """Make a property of the check that is decorated; the options are fields of `Property`.

    The check is called with the function, the case, and the arguments of the case by name. If
    `copied`, the function gets copies of what the check passes to it.
    """

    def stated(check: Check) -> Property:
        def with_copies(function: Callable, case: Case, **given: object) -> None:
            check(lambda *passed: function(*map(deepcopy, passed)), case, **given)

        return Property(name, statement, with_copies if copied else check, **options)

    return stated


def with_arguments(check: Check, arguments: Arguments) -> Callable[[Callable, Case], None]:
    """The check of a function in a case, whose arguments are drawn from the case."""
    return lambda function, case: check(function, case, **arguments(case))


@states("purity", "no argument is changed", copied=False, is_form=True, watches_state=True)
def purity(function, case, **given):
    """The property of every exercise whose arguments are arrays."""
    before = deepcopy(given)
    function(*given.values())
    for name, argument in before.items():
        after = dict(leaves(name, given[name]))
        for part, array in leaves(name, argument):
            if isinstance(array, np.ndarray) and not np.array_equal(after[part], array):
                raise Mismatch(ALTERED, part, f"the call changes {part}")


def drawn(**entries: object) -> Arguments:
    """Arguments drawn from a case, in the order of the call.

    An entry is a string, the sizes of an array such as "batch frames 3"; a function of the case
    and its random numbers; or a value.
    """

    def arguments(case: Case) -> dict[str, object]:
        rng = case.rng()
        return {name: _drawn(entry, case, rng) for name, entry in entries.items()}

    return arguments


def _drawn(entry: object, case: Case, rng: np.random.Generator) -> object:
    if isinstance(entry, str):
        sizes = entry.split()
        return spread(rng, tuple(int(s) if s.isdigit() else case[s] for s in sizes))
    return entry(case, rng) if callable(entry) else entry


def array(sizes: str, largest: float) -> Callable:
    """An entry of `drawn`: an array whose values lie between -largest and largest."""
    return lambda case, rng: spread(rng, tuple(case[size] for size in sizes.split()), largest)


def size(name: str) -> Callable:
    """An entry of `drawn`: one of the sizes."""
    return lambda case, rng: case[name]


class Recorded:
    """A function among the arguments of an exercise: the text is what a report prints for it.

    `calls` has the arguments and, last, the result of each call, as they were at that time.
    """

    def __init__(self, text: str, function: Callable) -> None:
        self.text = text
        self.function = function
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


@dataclass(frozen=True)
class Differentiated:
    """The properties of a function that returns a value and its derivatives.

    `returns` names the things that the function returns, the value first. The second one is
    `PULLBACK`, or the others are the gradients of a scalar value.
    """

    solution: Callable
    inputs: tuple[str, ...]  # the arguments that get a gradient, in the order of the gradients
    returns: tuple[str, ...]

    def value(self, statement: str) -> Property:
        """The value is that of the solution."""

        def check(function: Callable, case: Case, **given: object) -> None:
            expected, *_ = self.solution(*given.values())
            require_same(self._call(function, given)[0], expected, self.returns[:1])

        return states("value", statement)(check)

    def gradient(self, name: str, only: tuple[str, ...] = ()) -> Property:
        """Gradients agree with differences; `only` names the arrays, by default all."""

        def check(function: Callable, case: Case, **given: object) -> None:
            arrays = dict(all_leaves([given[i] for i in self.inputs], self.inputs))

            def f(*values):
                rest = iter(values)
                changed = {i: rebuilt(given[i], rest) for i in self.inputs}
                value, *others = self._call(function, given | changed)
                value = value if np.ndim(value) else np.float64(value)
                return value, lambda upstream: self._gradients(others, given, upstream)

            names = tuple(arrays)
            keys = (name.partition("['")[2].removesuffix("']") or name for name in names)
            chosen = [n for n, key in zip(names, keys, strict=True) if not only or key in only]
            problems = wrong_gradients(f, [*arrays.values()], names, case.rng(), only=chosen)
            function(*given.values())  # the call that a report shows
            if problems:
                first, *others = problems
                also = (f"also: {other.subject}" for other in others)
                message = "\n".join([str(first), *also])
                raise Mismatch(first.kind, first.subject, message)

        statement = "it agrees with central differences of the function that you wrote"
        return states(name, statement, is_gradient=True)(check)

    def keeps_float32(self) -> Property:
        """The value and the gradients of float32 arguments are float32."""

        def check(function: Callable, case: Case, **given: object) -> None:
            given = {name: _narrowed(name, argument) for name, argument in given.items()}
            value, *others = self._call(function, given)
            upstream = np.ones_like(value) if np.ndim(value) else 1.0
            results = [value, *self._gradients(others, given, upstream)]
            for result in results:
                dtype = np.asarray(result).dtype
                if dtype != np.float32 and type(result) is not float:
                    what = "the value" if result is value else "a gradient"
                    raise Mismatch(DTYPE, what, f"given float32, {what} is {dtype}")

        return states("dtype", "float32 stays float32", is_form=True)(check)

    def _call(self, function: Callable, given: Mapping[str, object]) -> list:
        returned = require_parts(function(*given.values()), self.returns)
        if PULLBACK in self.returns and not callable(returned[1]):
            raise TypeError(f"it does not return {' and '.join(self.returns)}")
        return list(returned)

    def _gradients(self, others: list, given: Mapping[str, object], upstream) -> tuple:
        """The gradients of all input arrays, from what the function returned after its value."""
        has_pullback = PULLBACK in self.returns
        pulled = others[0](upstream) if has_pullback else others
        every = gradients_of_leaves([given[i] for i in self.inputs], self.inputs, pulled)
        return tuple(every if has_pullback else (upstream * each for each in every))


def same_as(definition: Callable, *names: str) -> Check:
    """A check that a function returns what a definition returns: an array or a number, which has
    one name, or a tuple of these."""

    def check(function: Callable, case: Case, **given: object) -> None:
        require_same(function(*given.values()), definition(*map(deepcopy, given.values())), names)

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


def _narrowed(name: str, argument: object) -> object:
    """An argument with its float arrays as float32."""
    parts = (part for _, part in leaves(name, argument))
    narrow = (p.astype(np.float32) if getattr(p, "dtype", None) == np.float64 else p for p in parts)
    return rebuilt(argument, narrow)
