"""An exercise of a lesson: the function that a student writes, and its properties.

The file `lesson_NN.toml` states the exercises of a lesson (`entries.py`); `lesson_NN.py` has the
checks and the arguments that only they have. Most exercises are operations and have the properties
that `verify` states of them. The others (forward kinematics, the features, a step of descent, ...)
state their own, in the same form, so that all are drawn, shrunk, reported and graded in the same
way.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import import_module

from numpy_cae import ops
from numpy_cae.course.exercises import checks
from numpy_cae.course.exercises.arguments import Arguments, drawn
from numpy_cae.course.exercises.entries import FOLDER, entries_of, read_table
from numpy_cae.verify.operations.case import Sizes
from numpy_cae.verify.operations.catalogue import Exercise, properties_of_operation
from numpy_cae.verify.operations.operation import OPERATIONS, Operation
from numpy_cae.verify.operations.property import GRADIENT, REST, VALUE, Property
from numpy_cae.verify.operations.shared_properties import shared_properties

SOLUTIONS = "numpy_cae.course.solutions"
EVERY = read_table("every_exercise")
"""EVERY: the properties that exercises share, by the entry that states that they have them."""


SPECIAL: dict = {}
for path in sorted(FOLDER.glob("lesson_*.py")):
    SPECIAL |= vars(import_module(f"{__package__}.{path.stem}"))
"""SPECIAL: what is written for single exercises, by name; their checks are registered, too."""


def exercises_of(number: str) -> tuple[Exercise, ...]:
    """The exercises of a lesson."""
    solutions = import_module(f"{SOLUTIONS}.lesson_{number}")
    every = []
    for name, entries in entries_of(number).items():
        given = tuple(entries.get("given", "").split())
        if "arguments" in entries or "like" in entries:
            stated = Stated.of(getattr(solutions, name), entries)
            every.append(Exercise(name, stated.solution, tuple(stated.properties()), given=given))
        else:
            properties = properties_of_operation(name)
            every.append(Exercise(name, getattr(ops, name), properties, given=given))
    return tuple(every)


@dataclass(frozen=True)
class Stated:
    """The entries of an exercise that is no operation of `numpy_cae.ops`, and its solution."""

    solution: Callable
    entries: Mapping
    arguments: Arguments
    sizes: Sizes

    @classmethod
    def of(cls, solution: Callable, entries: Mapping) -> "Stated":
        """Find the arguments, which are an operation's, drawn as stated, or special ones."""
        sizes = _as_tuples(entries.get("sizes", {}))
        if "like" in entries:
            operation = OPERATIONS[entries["like"]]
            return cls(solution, entries, operation.arguments, {**operation.sizes, **sizes})
        stated = entries["arguments"]
        arguments = SPECIAL[stated] if isinstance(stated, str) else drawn(stated, SPECIAL)
        return cls(solution, entries, arguments, sizes)

    @property
    def inputs(self) -> tuple[str, ...]:
        """The arguments that get a gradient."""
        return tuple(self.entries.get("inputs", "").split())

    def properties(self) -> list[Property]:
        """Those of an operation if it returns a value and its pullback, else those stated."""
        if self.inputs and "returns" not in self.entries:
            return list(shared_properties(self._operation()))
        every = dict(self.entries.get("properties", {}))
        for entry, default in (("float32", False), ("pure", True)):
            every |= EVERY[entry] if self.entries.get(entry, default) else {}
        return [
            self._property(name, {"states": each} if isinstance(each, str) else each)
            for name, each in every.items()
        ]

    def _operation(self) -> Operation:
        """The value has to be that of the solution, the gradients those of the student's value."""
        stated = (self.solution.__name__, self.sizes, self.arguments, self.inputs)
        linear_in = tuple(self.entries.get("linear_in", "").split())
        options = {"reference": self.solution, "by_differences": True}
        return Operation(*stated, linear_in=linear_in, **options)

    def _property(self, name: str, entry: Mapping) -> Property:
        options = {"examples": entry["examples"]} if "examples" in entry else {}
        check = self._check(name, entry.get("gradient"), entry.get("part"))
        form = REST if entry.get("form") else VALUE
        return Property(
            name,
            entry.get("states", checks.AGREES),
            lambda function, case: check(function, case, **self.arguments(case)),
            operation=self.solution.__name__,
            arguments=self.arguments,
            sizes={**self.sizes, **_as_tuples(entry.get("sizes", {}))},
            group=GRADIENT if "gradient" in entry else form,
            **options,
        )

    def _check(self, name: str, gradient: str | None, part: str | list | None) -> checks.Check:
        """The check that only this exercise has, or the usual one for this property."""
        if special := checks.CHECKS.get((self.solution.__name__, name)):
            return special
        if any(name in shared for shared in EVERY.values()):
            return partial(getattr(checks, name), self.arguments)
        returns = tuple(self.entries.get("returns", ()))
        differentiated = checks.Differentiated(self.inputs, returns)
        if name == "upstream default":
            return checks.on_copies(differentiated.upstream_default)
        if gradient is not None:
            return checks.on_copies(partial(differentiated.gradient, gradient.split()))
        part = returns[0] if self.inputs else part
        return checks.on_copies(checks.same_as(self.solution, returns, part))


def _as_tuples(sizes: Mapping[str, list]) -> dict[str, tuple]:
    return {name: tuple(options) for name, options in sizes.items()}
