"""A report on one implementation: whether each property of its operation holds, with points.

`reply_of` and `report_of` are for a process that tests one function: outcomes as plain texts, and
outcomes again.
"""

import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from numpy_cae.verify.checks.call import ALTERED, LONGEST_TEXT
from numpy_cae.verify.operations import catalogue
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.catalogue import Exercise
from numpy_cae.verify.operations.property import Outcome, failing_case, failure
from numpy_cae.verify.operations.shared_properties import LARGEST
from numpy_cae.verify.operations.trial import try_property
from numpy_cae.visible import visible

WIDTH = 98
INDENT = 10
IN_ORDER = "a gradient counts once the value is right, other properties once gradients are, too"
UNSOLVED = NotImplementedError.__name__
"""UNSOLVED: the kind of an outcome where the function is still the stub of a lesson."""
ROUNDING = 1e-6
"""ROUNDING: a sum of points that is at most this below a whole number is that number."""


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
        return all(outcome.kind == UNSOLVED for outcome in self.outcomes)

    @property
    def points(self) -> int:
        return int(sum(self.earned()) + ROUNDING)

    def earned(self) -> list[float]:
        """Points per property.

        A property about the value earns its points alone, a gradient only if all of those hold,
        any other property only if values and gradients are right.
        """
        pairs = [(outcome.stated.group, outcome) for outcome in self.outcomes]
        failed = min((group for group, outcome in pairs if not outcome.held), default=2)
        return [o.stated.points if o.held and group <= failed else 0 for group, o in pairs]

    @property
    def possible(self) -> int:
        return round(sum(outcome.stated.points for outcome in self.outcomes))

    @property
    def held(self) -> bool:
        return all(outcome.held for outcome in self.outcomes)

    def __str__(self) -> str:
        return "\n".join(self._lines())

    __repr__ = __str__

    def _lines(self) -> Iterator[str]:
        title = self.called + ("" if self.called == self.operation else f" as {self.operation}")
        if self.held:
            every = len(self.outcomes)
            title += f": all {every} properties hold" if every > 1 else ": it holds"
        score = f"{self.points} of {self.possible} points"
        yield title + score.rjust(WIDTH - len(title))
        if self.unsolved:
            yield "  not solved yet. What will be checked:"
            for outcome in self.outcomes:
                head = f"  - {outcome.stated.name}: "
                yield from _wrapped(head, outcome.stated.statement, INDENT)
        elif not self.held:
            yield from self._failures()
        if self.exercise.hint and not self.held:
            yield from _wrapped("  hint: ", self.exercise.hint, 8)

    def _failures(self) -> Iterator[str]:
        """The first failing property in full, the others in short, and which hold."""
        first, *others = self.failing()
        yield from _wrapped(f"  FAILED  {first.stated.name}: ", first.stated.statement, INDENT)
        yield from _why(first)
        names_of: dict[tuple[str, str], list[str]] = {_reason(first): []}
        for outcome in others:
            names_of.setdefault(_reason(outcome), []).append(outcome.stated.name)
        yield from _listed("  FAILED  for the same reason: ", names_of.pop(_reason(first)))
        for (problem, mistake), names in names_of.items():
            yield from _wrapped(f"  FAILED  {', '.join(names)}: ", problem, INDENT)
            if mistake not in ("", first.mistake):
                yield from _wrapped(" " * INDENT + "likely:   ", mistake, 2 * INDENT + 2)
        untried = [o.stated.name for o in self.outcomes if not o.held and not o.problem]
        yield from _listed("  not tried: ", untried)
        yield from _listed("  hold: ", [o.stated.name for o in self.outcomes if o.held])
        both = zip(self.outcomes, self.earned(), strict=True)
        if any(outcome.held and not points for outcome, points in both):
            yield from _wrapped("  points: ", IN_ORDER, INDENT)

    def failing(self) -> list[Outcome]:
        """The properties that were tried and do not hold, the one about everything last.

        An altered argument is the cause of other failures, and comes first.
        """

        def place(outcome: Outcome) -> int:
            return (outcome.stated.name == LARGEST) - (outcome.kind == ALTERED)

        failing = [outcome for outcome in self.outcomes if outcome.problem and not outcome.held]
        return sorted(failing, key=place)


def _reason(outcome: Outcome) -> tuple[str, str]:
    return outcome.problem.splitlines()[0], outcome.mistake


def _listed(head: str, names: Sequence[str]) -> list[str]:
    return _wrapped(head, ", ".join(names), INDENT) if names else []


def _why(outcome: Outcome) -> Iterator[str]:
    """The lines below a property that does not hold, not too many of each kind."""
    shown = [("what", outcome.problem, 9), ("smallest", outcome.counterexample, 13)]
    shown += [("likely", outcome.mistake, 4), ("hint", outcome.stated.hint, 4)]
    for title, text, most in shown:
        lines: list[str] = []
        for i, line in enumerate(text.splitlines()):
            head = " " * INDENT + (f"{title}:" if i == 0 else "").ljust(INDENT)
            lines += _wrapped(head + "  " * line.startswith(" "), line.strip(), 2 * INDENT + 2)
        yield from lines[:most]


def _wrapped(head: str, text: str, indent: int) -> list[str]:
    options = {"initial_indent": head, "subsequent_indent": " " * indent}
    return textwrap.wrap(text, WIDTH, break_on_hyphens=False, **options)


def report(operation: str | Exercise, function: Callable, called: str | None = None) -> Report:
    """Test an implementation for every property of an operation.

    Parameters
    ----------
    operation : str or Exercise
        An operation of `numpy_cae.ops`, "tied_layer", or an exercise.
    function : callable
        With the arguments of that operation; returns a value and its pullback.
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
    exercise = catalogue.find_exercise(operation)
    called = called or getattr(function, "__name__", exercise.name)
    return Report(exercise, called, tested(exercise, function))


def tested(
    exercise: Exercise,
    function: Callable,
    begin: Callable[[Sequence[Outcome], Case], None] = lambda outcomes, case: None,
) -> tuple[Outcome, ...]:
    """The outcome of every property.

    `begin` is called before each case, with the outcomes of the properties before. If the function
    raises, or returns something else than it has to, in every case, no other property is tried.
    """
    first, *others = exercise.properties
    outcomes = [try_property(first, function, begin=partial(begin, ()))]
    is_unsolved = outcomes[0].kind == UNSOLVED
    errors = (failure(first, function, case) for case in first.cases())
    answers = not is_unsolved and any(isinstance(e, AssertionError | None) for e in errors)
    for stated in others:
        untried = Outcome(stated, False, UNSOLVED * is_unsolved, kind=UNSOLVED * is_unsolved)
        begin_next = partial(begin, outcomes)
        outcomes.append(try_property(stated, function, begin=begin_next) if answers else untried)
    return tuple(outcomes)


def holds(exercise: Exercise, implementation: Callable) -> bool:
    """Whether every property holds; stops at the first that does not."""
    return all(failing_case(tried, implementation) is None for tried in exercise.properties)


def readable(text: str) -> str:
    """A text of readable length, control characters escaped."""
    return visible(text[:LONGEST_TEXT])


TEXTS = ("problem", "counterexample", "mistake", "kind")


def reply_of(outcomes: Sequence[Outcome]) -> dict:
    """The outcomes in plain dicts, lists and texts."""
    return {"outcomes": [{name: getattr(o, name) for name in ("held", *TEXTS)} for o in outcomes]}


def report_of(exercise: Exercise, reply: dict) -> Report:
    """The report from a reply of `reply_of`, or one that says why there is no such reply.

    If the process was ended, the outcomes until then count. Names, statements and points are not
    taken from the reply.
    """
    outcomes: list[Outcome] = []
    try:
        problem = readable(reply["failed"])
        sent = reply.get("outcomes", ()) if problem else reply["outcomes"]
        outcomes = [
            Outcome(stated, one["held"] is True, *(readable(one[name]) for name in TEXTS))
            for stated, one in zip(exercise.properties, sent, strict=not problem)
        ]
        if "trying" in reply and problem:
            problem += f"\nit was tried with {readable(reply['trying'])}; smaller cases were right"
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        problem = f"its process sent no reply: {error}"
    left = exercise.properties[len(outcomes) :]
    outcomes += [Outcome(stated, False, problem * (stated is left[0])) for stated in left]
    return Report(exercise, exercise.name, tuple(outcomes))
