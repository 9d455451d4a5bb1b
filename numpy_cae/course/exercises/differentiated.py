"""The checks of a function that returns a value and its derivatives.

Gradients have the structure of the argument that they belong to.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.course.exercises.checks import require_parts, require_same
from numpy_cae.verify.checks.call import all_leaves, gradients_of_leaves, leaves, rebuilt
from numpy_cae.verify.checks.gradients import wrong_gradients
from numpy_cae.verify.checks.mismatch import DTYPE, Mismatch
from numpy_cae.verify.operations.case import Case

PULLBACK = "the pullback"
AGREES = "it agrees with central differences of the function that you wrote"
"""AGREES: the statement of each gradient's property."""
KEY = re.compile(r"\w+\['(\w+)'\]")
"""KEY: the name of an array in a dict, such as weights['w'], whose key is w."""


@dataclass(frozen=True)
class Differentiated:
    """The checks of a function that returns a value and its derivatives.

    `returns` names the things that the function returns, the value first. The second one is
    `PULLBACK`, or the others are the gradients of a scalar value.
    """

    solution: Callable
    inputs: tuple[str, ...]  # the arguments that get a gradient, in the order of the gradients
    returns: tuple[str, ...]

    def value(self, function: Callable, case: Case, **given: object) -> None:
        """The value is that of the solution."""
        expected, *_ = self.solution(*given.values())
        require_same(self._call(function, given)[0], expected, self.returns[:1])

    def gradient(self, only: Sequence[str], function: Callable, case: Case, **given) -> None:
        """Gradients agree with differences; `only` names the arrays, none being all."""
        arrays = dict(all_leaves([given[i] for i in self.inputs], self.inputs))

        def f(*values):
            rest = iter(values)
            changed = {i: rebuilt(given[i], rest) for i in self.inputs}
            value, *others = self._call(function, given | changed)
            value = value if np.ndim(value) else np.float64(value)
            return value, lambda upstream: self._gradients(others, given, upstream)

        chosen = [n for n in arrays if not only or KEY.sub(r"\1", n) in only]
        problems = wrong_gradients(f, [*arrays.values()], (*arrays,), case.rng(), only=chosen)
        function(*given.values())  # the call that a report shows
        if problems:
            first, *others = problems
            also = (f"also: {other.subject}" for other in others)
            raise Mismatch(first.kind, first.subject, "\n".join([str(first), *also]))

    def dtype(self, function: Callable, case: Case, **given: object) -> None:
        """The value and the gradients of float32 arguments are float32."""
        given = {name: _narrowed(name, argument) for name, argument in given.items()}
        value, *others = self._call(function, given)
        upstream = np.ones_like(value) if np.ndim(value) else 1.0
        results = [value, *self._gradients(others, given, upstream)]
        for result in results:
            dtype = np.asarray(result).dtype
            if dtype != np.float32 and type(result) is not float:
                what = "the value" if result is value else "a gradient"
                raise Mismatch(DTYPE, what, f"given float32, {what} is {dtype}")

    def upstream_default(self, function: Callable, case: Case, **given: object) -> None:
        """Without an upstream gradient it is 1."""
        _, pullback = self._call(function, given)
        require_same(pullback(), pullback(1.0), ("the gradient without an argument",))

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


def _narrowed(name: str, argument: object) -> object:
    """An argument with its float arrays as float32."""
    parts = (part for _, part in leaves(name, argument))
    narrow = (p.astype(np.float32) if getattr(p, "dtype", None) == np.float64 else p for p in parts)
    return rebuilt(argument, narrow)
