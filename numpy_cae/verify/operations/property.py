"""A property: a sentence about a function, and the check that tests an implementation for it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from numpy_cae.verify.operations.case import Case, Sizes, random_cases
from numpy_cae.verify.operations.compare import Comparison
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.shapes import Arguments

EXAMPLES = 24
"""A property that does not set `examples` is tried on at least this many cases."""
VALUE = 0
"""The group of properties about the value, whose points come first in a report."""
GRADIENT = 1
"""The group of properties about a gradient."""
REST = 2
"""The group of all other properties."""


def _no_arguments(case: Case) -> dict[str, Any]:
    return {}


@dataclass(frozen=True)
class Property:
    """A sentence about a function, and the check that raises where the sentence is false.

    `operation` names the operation or exercise, `arguments` makes the arguments of a case.

    Examples
    --------
    >>> from numpy_cae import ops, verify
    >>> value = verify.properties("conv1d")[0]
    >>> value.name, value.statement
    ('value', 'the value is that of the definition, loop by loop')
    >>> verify.check_property(value, ops.conv1d)
    """

    name: str
    statement: str
    check: Callable[[Callable, Case], None] = field(repr=False)
    points: float = 1
    sizes: Sizes = field(default_factory=dict, repr=False)
    examples: int = EXAMPLES  # the number of cases
    operation: str = ""
    arguments: Arguments = field(default=_no_arguments, repr=False)
    hint: str = ""
    combined: tuple[str, ...] = ()  # every combination of these sizes and classes is drawn
    full_size_classes: tuple[dict[str, str], ...] = ()  # tried with the last option of every size
    diagnose: Callable[..., str] | None = field(default=None, repr=False)  # in place of diagnosis
    group: int = VALUE  # or GRADIENT, or REST: what functions without the right value may have
    example_of: str = ""  # how a report names it in a call of `example`
    seeded_by: str = ""  # what the cases depend on, by default the operation
    marks: Any = ()  # of pytest
    most_cases: int | None = None  # of all cases only so many, evenly chosen, are tried

    def cases(self) -> list[Case]:
        """Random cases, the same in every run, smallest arrays first."""
        name = f"{self.seeded_by or self.operation}: {self.name}"
        cases = random_cases(name, self.sizes, self.examples, self.combined, self.full_size_classes)
        if self.most_cases is None or self.most_cases >= len(cases):
            return cases
        return [cases[i * len(cases) // self.most_cases] for i in range(self.most_cases)]

    @property
    def comparison(self) -> Comparison | None:
        """The check, if it compares the results of an operation."""
        return self.check if isinstance(self.check, Comparison) else None

    @property
    def definition(self) -> Operation | None:
        """The operation, if its value and pullback have a definition to compare with."""
        if self.comparison is None or self.comparison.operation.reference is None:
            return None
        return self.comparison.operation


@dataclass(frozen=True)
class Outcome:
    """Whether a property holds; if not, why, in which case, and the likely mistake."""

    property_: Property
    held: bool
    problem: str = ""
    counterexample: str = ""
    mistake: str = ""
    kind: str = ""  # of the mismatch, or the type of another error
    crashed: bool = False  # whether the implementation raised
