"""A wrong gradient of a composed layer beside the right one, as whole arrays while they are small.

One entry shows that a gradient is wrong, the whole of it how: flipped, transposed, a term missing.
"""

from collections.abc import Callable
from dataclasses import dataclass

from numpy_cae.verify.checks.mismatch import Mismatch
from numpy_cae.verify.checks.written import written
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.property import (
    Comparison,
    agrees,
    copies,
    differentiated,
    drawn_upstream,
)

LARGEST = 12
"""LARGEST: gradients with at most so many entries are shown whole."""


@dataclass(frozen=True)
class WholeGradient(Comparison):
    """The check of the gradient for one argument; a Mismatch has both gradients."""

    argument: str
    solution: Callable

    def __call__(self, implementation: Callable, case: Case) -> None:
        """Compare, and add both gradients to what is wrong in an entry."""
        try:
            super().__call__(implementation, case)
        except Mismatch as error:
            both = self._both(implementation, case) if error.kind == "slope" else ""
            if not both:
                raise
            raise Mismatch(error.kind, error.subject, f"{error}{both}") from None

    def _both(self, implementation: Callable, case: Case) -> str:
        """Both gradients, or "" where they are large or the values differ, too."""
        made = [self._value_and_gradient(f, case) for f in (implementation, self.solution)]
        (value, whole), (expected, right) = made
        if right.size > LARGEST or not agrees(value, expected):
            return ""
        pad = " " * 4
        return f"\n{pad}the whole gradient  {written(whole)}\n{pad}the right one  {written(right)}"

    def _value_and_gradient(self, function: Callable, case: Case) -> tuple:
        value, pullback = function(*copies(self.operation.arguments(case)))
        pulled = pullback(drawn_upstream(case, value))
        return value, differentiated(self.operation, pulled)[self.argument]
