"""Properties of an exercise's function, and the checks that recur in the exercises.

An argument is a number, an array, a dict of arrays by name, a list of arrays, or a list of the
pairs (w, b) of each layer. Gradients have the structure of the argument that they belong to.
"""

from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from numpy_cae.verify.checks.gradients import check_gradients
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import Property, require_equal

Arguments = Callable[[Case], dict[str, object]]
Check = Callable[[Callable, Case], None]
PULLBACK = "the pullback"


def states(name: str, statement: str, points: int = 1, **options) -> Callable[[Check], Property]:
    """Make a property of the check that is decorated; the arguments are those of `Property`."""
    return lambda check: Property(name, statement, check, points, **options)


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


def array(sizes: str, reach: float) -> Callable:
    """An entry of `drawn`: an array whose values lie between -reach and reach."""
    return lambda case, rng: spread(rng, tuple(case[size] for size in sizes.split()), reach)


def size(name: str) -> Callable:
    """An entry of `drawn`: one of the sizes."""
    return lambda case, rng: case[name]


@dataclass(frozen=True)
class Differentiated:
    """A function that returns a value and its derivatives, and its properties.

    `returns` names the things that it returns, the value first. The second is `PULLBACK`, or the
    others are the gradients of a scalar value.
    """

    arguments: Arguments
    definition: Callable  # the value, from the same arguments
    inputs: tuple[str, ...]  # the arguments that get a gradient, in the order of the gradients
    returns: tuple[str, ...]

    def value(self, statement: str) -> Property:
        """The property that the value is that of the definition."""

        def check(function: Callable, case: Case) -> None:
            value = self._call(function, self.arguments(case))[0]
            expected = self.definition(*copies(self.arguments(case)))
            require_same(value, expected, self.returns[:1])

        return Property("value", statement, check, 2)

    def gradient(self, name: str, points: int, only: tuple[str, ...] | None = None) -> Property:
        """The property that gradients agree with differences: of all arrays, or `only` of some."""

        def check(function: Callable, case: Case) -> None:
            given = self.arguments(case)
            arrays = {k: v for i in self.inputs for k, v in arrays_in(i, given[i]).items()}

            def f(*values):
                rest = iter(values)
                changed = {i: _rebuilt(given[i], rest) for i in self.inputs}
                value, *others = self._call(function, given | changed)
                value = value if np.ndim(value) else np.float64(value)
                return value, lambda upstream: self._gradients(others, given, upstream)

            names = tuple(arrays)
            chosen = names if only is None else tuple(name for name in names if name in only)
            try:
                check_gradients(f, *arrays.values(), rng=case.rng(), names=names, only=chosen)
            finally:  # the call that a report shows
                function(*copies(given))

        statement = "it agrees with central differences of the function that you wrote"
        return Property(name, statement, check, points)

    def keeps_float32(self) -> Property:
        """The property that value and gradients of float32 arguments are float32."""

        def check(function: Callable, case: Case) -> None:
            given = {name: _narrowed(name, a) for name, a in self.arguments(case).items()}
            value, *others = self._call(function, given)
            upstream = np.ones_like(value) if np.ndim(value) else np.float32(1)
            results = [value, *self._gradients(others, given, upstream)]
            for result in results:
                dtype = np.asarray(result).dtype
                if dtype != np.float32 and type(result) is not float:
                    what = "the value" if result is value else "a gradient"
                    raise AssertionError(f"given float32, {what} is {dtype}")

        return Property("dtype", "float32 stays float32", check)

    def _call(self, function: Callable, given: Mapping[str, object]) -> list:
        returned = require_parts(function(*copies(given)), self.returns)
        if PULLBACK in self.returns and not callable(returned[1]):
            raise AssertionError(f"it does not return {' and '.join(self.returns)}")
        return list(returned)

    def _gradients(self, others: list, given: Mapping[str, object], upstream) -> tuple:
        """The gradients of all input arrays, from what the function returned beside its value."""
        if PULLBACK in self.returns:
            pulled = others[0](upstream)
            one = len(self.inputs) == 1
            others = (pulled,) if one else require_parts(pulled, [f"d{i}" for i in self.inputs])
            upstream = None
        flat = [
            gradient
            for name, of_name in zip(self.inputs, others, strict=True)
            for gradient in _gradients_in(given[name], of_name)
        ]
        return tuple(flat if upstream is None else (upstream * each for each in flat))


def same_as(definition: Callable, arguments: Arguments, *names: str) -> Check:
    """A check that a function returns what a definition returns: an array or a number, which has
    one name, or a tuple of these."""

    def check(function: Callable, case: Case) -> None:
        expected = definition(*copies(arguments(case)))
        require_same(function(*copies(arguments(case))), expected, names)

    return check


def unchanged(arguments: Arguments) -> Property:
    """The property that a function does not change its arguments."""

    def check(function: Callable, case: Case) -> None:
        before, given = arguments(case), copies(arguments(case))
        function(*given)
        for (name, argument), after in zip(before.items(), given, strict=True):
            now = arrays_in(name, after)
            for part, array in arrays_in(name, argument).items():
                if not np.array_equal(now[part], array):
                    raise AssertionError(f"the call changes {part}")

    return Property("purity", "no argument is changed", check)


def require_same(found, expected, names: tuple[str, ...] = ()) -> None:
    """Raise unless a result equals the expected one, part by part if that is a tuple."""
    if not isinstance(expected, tuple):
        found, expected = (found,), (expected,)
        names = names[:1] or ("the value",)
    names = names or tuple(f"value {number}" for number in range(len(expected)))
    if not isinstance(found, tuple | list) or len(found) != len(expected):
        what = f"{len(found)} values" if isinstance(found, tuple | list) else type(found).__name__
        raise AssertionError(f"it returns {what}, expected {', '.join(names)}")
    for name, one, other in zip(names, found, expected, strict=False):
        if one is None:
            raise AssertionError(f"{name} is None: is a return missing?")
        if np.asarray(one).dtype.kind not in "biuf":
            raise AssertionError(f"{name} is {type(one).__name__}, expected numbers")
        require_equal(name, one, other)


def require_parts(returned, names) -> tuple | list:
    """What a function returned; AssertionError unless it is one thing for each name."""
    if not isinstance(returned, tuple | list) or len(returned) != len(names):
        raise AssertionError(f"it does not return {len(names)} things: {', '.join(names)}")
    return returned


def copies(arguments: Mapping[str, object]) -> list:
    """The arguments in the order of the call, copied."""
    return deepcopy(list(arguments.values()))


def arrays_in(name: str, argument: object) -> dict[str, np.ndarray]:
    """The arrays of an argument by name; a dict of arrays has names of its own."""
    if isinstance(argument, np.ndarray):
        return {name: argument}
    if isinstance(argument, dict):
        return dict(argument)
    if not isinstance(argument, list):
        return {}
    if all(isinstance(entry, np.ndarray) for entry in argument):
        return {f"{name}[{n}]": entry for n, entry in enumerate(argument)}
    layers = enumerate(argument, 1)
    return {f"{of} of layer {n}": a for n, pair in layers for of, a in zip("wb", pair, strict=True)}


def _rebuilt(argument: object, arrays: Iterator[np.ndarray]) -> object:
    """An argument of the same structure with other arrays."""
    if isinstance(argument, np.ndarray):
        return next(arrays)
    if isinstance(argument, dict):
        return {name: next(arrays) for name in argument}
    return [tuple(next(arrays) for _ in pair) for pair in argument]


def _narrowed(name: str, argument: object) -> object:
    """An argument with its float arrays as float32."""
    arrays = arrays_in(name, argument).values()
    narrow = (a.astype(np.float32) if a.dtype == np.float64 else a for a in arrays)
    return _rebuilt(argument, narrow) if arrays else argument


def _gradients_in(argument: object, gradients) -> list[np.ndarray]:
    """The gradients of an argument's arrays, in their order; AssertionError if they are not in its
    structure."""
    if isinstance(argument, dict):
        if not isinstance(gradients, dict):
            found = type(gradients).__name__
            raise AssertionError(f"expected a dict of gradients by name, got {found}")
        missing = [name for name in argument if name not in gradients]
        if missing:
            raise AssertionError(f"no gradient for {', '.join(missing)}")
        return [gradients[name] for name in argument]
    if isinstance(argument, list):
        names = [f"(dw, db) of layer {n}" for n in range(1, len(argument) + 1)]
        pairs = require_parts(gradients, names)
        return [gradient for pair in pairs for gradient in require_parts(pair, ("dw", "db"))]
    return [gradients]
