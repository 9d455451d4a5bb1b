"""A report on one implementation: whether each property of its operation holds, with points."""

import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice

from numpy_cae.verify.operations.catalogue import (
    CONTRACT,
    Exercise,
    find_exercise,
    in_other_conventions,
)
from numpy_cae.verify.operations.property import Outcome
from numpy_cae.verify.operations.trial import LONGEST_TEXT, failing_case, try_property
from numpy_cae.visible import visible

WIDTH = 98
INDENT = 10
LONGEST_REASON = 28
FORM = ("linearity", "dtype", "purity", "independence", "strides", "x restored", "inputs stay")
STAGES = {"value": 0, "gradient": 1, "adjoint": 1}
WHY = ("problem", "counterexample", "likely_mistake")
UNSOLVED = NotImplementedError.__name__


@dataclass(frozen=True)
class Report:
    """The outcome of every property. Prints, and is shown in a notebook, as a table."""

    exercise: Exercise
    called: str
    outcomes: tuple[Outcome, ...]

    @property
    def operation(self) -> str:
        return self.exercise.name

    @property
    def unsolved(self) -> bool:
        """Whether the function is still the stub of a lesson."""
        return all(outcome.problem.startswith(UNSOLVED) for outcome in self.outcomes)

    @property
    def points(self) -> int:
        return sum(self.earned())

    def earned(self) -> list[int]:
        """Points per property.

        A gradient earns points only if the value is right, every other property only if value and
        gradients are. Where a function has neither, its form comes after its other properties.
        """
        names = [outcome.stated.name for outcome in self.outcomes]
        stages = [STAGES.get(name.partition(" ")[0].rstrip("s"), 2) for name in names]
        if min(stages) == 2:
            stages = [2 if name in FORM else 0 for name in names]
        pairs = list(zip(stages, self.outcomes, strict=True))
        failed = min((stage for stage, outcome in pairs if not outcome.held), default=2)
        return [o.stated.points if o.held and stage <= failed else 0 for stage, o in pairs]

    @property
    def possible(self) -> int:
        return sum(outcome.stated.points for outcome in self.outcomes)

    @property
    def held(self) -> bool:
        return all(outcome.held for outcome in self.outcomes)

    def __str__(self) -> str:
        return "\n".join(self._lines())

    __repr__ = __str__

    def as_json(self) -> dict:
        """The report in plain dicts, lists and numbers."""
        return {
            "operation": self.operation,
            "function": self.called,
            "convention": self.exercise.convention,
            "points": self.points,
            "possible": self.possible,
            "held": self.held,
            "properties": [
                {
                    "name": outcome.stated.name,
                    "statement": outcome.stated.statement,
                    "held": outcome.held,
                    "points": points,
                    "possible": outcome.stated.points,
                    "problem": outcome.problem,
                    "counterexample": outcome.counterexample,
                    "likely_mistake": outcome.mistake,
                    "case": outcome.case and [outcome.case.sizes, outcome.case.seed],
                }
                for outcome, points in zip(self.outcomes, self.earned(), strict=True)
            ],
        }

    def _lines(self) -> Iterator[str]:
        as_what = "" if self.called == self.operation else f" as {self.operation}"
        title = self.called + as_what
        score = f"{self.points} of {self.possible} points"
        yield title + score.rjust(WIDTH - len(title))
        if self.exercise.convention != CONTRACT:
            note = "Right, but in another convention than numpy_cae's: "
            yield from _wrapped("  ", f"{note}{self.exercise.convention}.", 2)
        if self.unsolved:
            yield "  not solved yet. What will be checked:"
        longest = max(len(outcome.stated.name) for outcome in self.outcomes)
        reasons: dict[tuple[str, str], str] = {}
        for outcome, earned in zip(self.outcomes, self.earned(), strict=True):
            tried = outcome.stated
            word = "held" if outcome.held else "-" if self.unsolved else "FAILED"
            head = f"  {word:8}{tried.name:{longest}}  {earned}/{tried.points}  "
            yield from _wrapped(head, tried.statement, len(head))
            if not outcome.held and not self.unsolved:
                why = (outcome.problem, outcome.mistake)
                if why in reasons:
                    yield " " * INDENT + f"as for {reasons[why]}"
                else:
                    reasons[why] = tried.name
                    yield from _why(outcome)
        if self.exercise.hint and not self.held:
            yield from _wrapped("  hint: ", self.exercise.hint, 8)


def _why(outcome: Outcome) -> Iterator[str]:
    """The lines below a property that does not hold, at most LONGEST_REASON."""
    yield from islice(_every_reason(outcome), LONGEST_REASON)


def _every_reason(outcome: Outcome) -> Iterator[str]:
    for title, text in (
        ("what", outcome.problem),
        ("smallest", outcome.counterexample),
        ("likely", outcome.mistake),
        ("hint", outcome.stated.hint),
    ):
        for i, line in enumerate(text.splitlines()):
            head = " " * INDENT + (f"{title}:" if i == 0 else "").ljust(INDENT)
            yield from _wrapped(head + "  " * line.startswith(" "), line.strip(), 2 * INDENT + 2)


def _wrapped(head: str, text: str, indent: int) -> list[str]:
    options = {"initial_indent": head, "subsequent_indent": " " * indent}
    return textwrap.wrap(text, WIDTH, break_on_hyphens=False, **options)


def report(
    operation: str | Exercise,
    function: Callable,
    any_convention: bool = False,
    called: str | None = None,
) -> Report:
    """Test an implementation for every property of an operation.

    Parameters
    ----------
    operation : str or Exercise
        An operation of `numpy_cae.ops`, "tied_layer", or an exercise.
    function : callable
        With the arguments of that operation; returns a value and its pullback.
    any_convention : bool
        Whether another documented convention may be followed, such as GRU gates in another order.
    called : str, optional
        The name of the function in the report; by default its `__name__`.

    Returns
    -------
    Report
        Prints as a table: for each property whether it holds, the points, and if not, why, the
        smallest counterexample and the likely mistake.

    Raises
    ------
    ValueError
        If there is no such operation.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> def tanh(x):
    ...     return np.tanh(x), lambda dy: dy * (1 - x * x)
    >>> made = verify.report("tanh", tanh)
    >>> made.points, made.possible
    (2, 11)
    >>> made.outcomes[1].stated.name, made.outcomes[1].mistake
    ('gradient for x', 'The derivative is 1 - x², where it should be 1 - y².')
    """
    exercise = find_exercise(operation)
    called = called or getattr(function, "__name__", exercise.name)
    if any_convention:
        for followed in (exercise, *in_other_conventions(exercise)):
            if holds(followed, function):
                return Report(
                    followed, called, tuple(Outcome(p, True) for p in followed.properties)
                )
    outcomes = [try_property(exercise.properties[0], function)]
    unsolved = outcomes[0].problem.startswith(UNSOLVED)
    for stated in exercise.properties[1:]:
        stub = Outcome(stated, held=False, problem=UNSOLVED)
        outcomes.append(stub if unsolved else try_property(stated, function))
    return Report(exercise, called, tuple(outcomes))


def report_from_reply(exercise: Exercise, called: str, reply: dict) -> Report:
    """The report that another process made, or a report that says why there is none.

    The reply is `Report.as_json`; names, statements and points are not taken from it.
    """
    try:
        problem = readable(reply.get("failed", ""))
        if not problem:
            every = (exercise, *in_other_conventions(exercise))
            (followed,) = (one for one in every if one.convention == reply["convention"])
            both = zip(followed.properties, reply["properties"], strict=True)
            outcomes = (
                Outcome(stated, one["held"] is True, *(readable(one[key]) for key in WHY))
                for stated, one in both
            )
            return Report(followed, called, tuple(outcomes))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        problem = f"its process sent no reply: {error}"
    return Report(exercise, called, tuple(Outcome(p, False, problem) for p in exercise.properties))


def holds(exercise: Exercise, implementation: Callable) -> bool:
    """Whether every property holds; stops at the first that does not."""
    return all(failing_case(tried, implementation) is None for tried in exercise.properties)


def readable(text: str) -> str:
    """A text of readable length, control characters escaped."""
    return visible(text[:LONGEST_TEXT])
