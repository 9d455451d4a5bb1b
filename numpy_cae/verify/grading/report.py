"""A report on one implementation: whether each property of its operation holds, with points.

`reply_of` and `report_of` are for a process that tests one function: outcomes as plain texts, and
outcomes again.
"""

import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from numpy_cae.verify.checks.messages import LONGEST_TEXT
from numpy_cae.verify.checks.mismatch import ALTERED
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.counterexample import failing_case, failure
from numpy_cae.verify.operations.operation_catalogue import Exercise, find_exercise
from numpy_cae.verify.operations.property import REST, Outcome, Property
from numpy_cae.verify.operations.shared_properties import LARGEST
from numpy_cae.verify.operations.trial import try_property
from numpy_cae.visible import visible

WIDTH = 98
IN_ORDER = "a gradient counts once the value is right, other properties once gradients are, too"
UNSOLVED = NotImplementedError.__name__
"""The kind of an outcome where the function is still the stub of a lesson."""
ROUNDING = 1e-6
"""A sum of points that is at most this below a whole number is that number."""
HINT_LINES = 4
"""So many lines of a likely mistake, and of a hint, are shown."""

Begin = Callable[[Sequence[Outcome], Case], None]
"""What is called before a case is tried, with the outcomes of the properties before."""


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
        return int(sum(self.points_earned()) + ROUNDING)

    def points_earned(self) -> list[float]:
        """Points per property.

        A property about the value earns its points alone, a gradient only if all of those hold,
        any other property only if values and gradients are right.
        """
        failing_groups = [outcome.property_.group for outcome in self.outcomes if not outcome.held]
        first_failing = min(failing_groups, default=REST)
        points = []
        for outcome in self.outcomes:
            counts = outcome.held and outcome.property_.group <= first_failing
            points.append(outcome.property_.points if counts else 0)
        return points

    @property
    def possible(self) -> int:
        return round(sum(outcome.property_.points for outcome in self.outcomes))

    @property
    def held(self) -> bool:
        return all(outcome.held for outcome in self.outcomes)

    def __str__(self) -> str:
        return "\n".join([self.title(), *self.items()])

    __repr__ = __str__

    def title(self) -> str:
        """The first line: what was tested, and the points."""
        title = self.called
        if self.called != self.operation:
            title += f" as {self.operation}"
        if self.held:
            count = len(self.outcomes)
            title += f": all {count} properties hold" if count > 1 else ": it holds"
        score = f"{self.points} of {self.possible} points"
        return title + score.rjust(WIDTH - len(title))

    def items(self) -> list[str]:
        """What is said below the title, each item in one or more lines; the hint comes last."""
        items = []
        if self.unsolved:
            items.append("  not solved yet. What will be checked:")
            for outcome in self.outcomes:
                head = f"  - {outcome.property_.name}: "
                items.append(_wrap(head, outcome.property_.statement, INDENT))
        elif not self.held:
            items += self._failures()
        if self.exercise.hint and not self.held:
            items.append(_wrap("  hint: ", self.exercise.hint, 8))
        return items

    def _failures(self) -> Iterator[str]:
        """The first failing property in full, the others in short, and which hold."""
        first, *further = self.failing()
        head = f"  FAILED  {first.property_.name}: "
        yield "\n".join([_wrap(head, first.property_.statement, INDENT), *_describe_failure(first)])
        names_of: dict[tuple[str, str], list[str]] = {_reason(first): []}
        for outcome in further:
            names_of.setdefault(_reason(outcome), []).append(outcome.property_.name)
        if same_reason := names_of.pop(_reason(first)):
            yield _wrap("  FAILED  for the same reason: ", ", ".join(same_reason), INDENT)
        for (problem, mistake), names in names_of.items():
            item = _wrap(f"  FAILED  {', '.join(names)}: ", problem, INDENT)
            if mistake not in ("", first.mistake):
                likely = _wrap(" " * INDENT + "likely:   ", mistake, 2 * INDENT + 2)
                item = f"{item}\n{likely}"
            yield item
        if untried := [o.property_.name for o in self.outcomes if not o.held and not o.problem]:
            yield _wrap("  not tried: ", ", ".join(untried), INDENT)
        if holding := [o.property_.name for o in self.outcomes if o.held]:
            yield _wrap("  hold: ", ", ".join(holding), INDENT)
        pairs = zip(self.outcomes, self.points_earned(), strict=True)
        if any(outcome.held and not points for outcome, points in pairs):
            yield _wrap("  points: ", IN_ORDER, INDENT)

    def failing(self) -> list[Outcome]:
        """The properties that were tried and do not hold, the one about everything last.

        An altered argument is the cause of other failures, and comes first.
        """

        def place(outcome: Outcome) -> int:
            return (outcome.property_.name == LARGEST) - (outcome.kind == ALTERED)

        failing = [outcome for outcome in self.outcomes if outcome.problem and not outcome.held]
        return sorted(failing, key=place)


def _reason(outcome: Outcome) -> tuple[str, str]:
    """What two properties that fail for the same reason have in common."""
    return outcome.problem.splitlines()[0], outcome.mistake


PROBLEM_LINES = 9
"""So many lines of a problem are shown."""
EXAMPLE_LINES = 13
"""So many lines of a counterexample are shown."""


def _describe_failure(outcome: Outcome) -> Iterator[str]:
    """The lines below a property that does not hold, not too many of each kind."""
    yield from _titled_lines("what:", outcome.problem)[:PROBLEM_LINES]
    yield from _titled_lines("smallest:", outcome.counterexample)[:EXAMPLE_LINES]
    yield from _titled_lines("likely:", outcome.mistake)[:HINT_LINES]
    yield from _titled_lines("hint:", outcome.property_.hint)[:HINT_LINES]


INDENT = 10


def _titled_lines(title: str, text: str) -> list[str]:
    """The lines of a text beside a title, lines that begin with a space indented."""
    lines: list[str] = []
    for line in text.splitlines():
        head = " " * INDENT + title.ljust(INDENT)
        if line.startswith(" "):
            head += "  "
        lines += _wrap(head, line.strip(), 2 * INDENT + 2).splitlines()
        title = ""
    return lines


def _wrap(head: str, text: str, indent: int) -> str:
    """A text behind a head, further lines indented."""
    return textwrap.fill(
        text,
        WIDTH,
        initial_indent=head,
        subsequent_indent=" " * indent,
        break_on_hyphens=False,
    )


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
    >>> tanh_report = verify.report("tanh", tanh)
    >>> tanh_report.points, tanh_report.possible
    (2, 11)
    >>> tanh_report.outcomes[1].property_.name, tanh_report.outcomes[1].mistake
    ('gradient for x', 'The derivative is 1 - x², where it should be 1 - y².')
    """
    exercise = find_exercise(operation)
    called = called or str(getattr(function, "__name__", exercise.name))
    return Report(exercise, called, try_all(exercise, function))


def try_all(
    exercise: Exercise, function: Callable, begin: Begin | None = None
) -> tuple[Outcome, ...]:
    """The outcome of every property.

    `begin` is called before each case, with the outcomes of the properties before. If the function
    raises, or returns something else than it has to, in every case, no other property is tried.
    """
    first, *further = exercise.properties
    outcomes: list[Outcome] = []
    outcomes.append(_try_next(first, function, outcomes, begin))
    if outcomes[0].kind == UNSOLVED:
        unsolved = [Outcome(property_, False, UNSOLVED, kind=UNSOLVED) for property_ in further]
        return (*outcomes, *unsolved)
    if not _answers(first, function):
        return (*outcomes, *(Outcome(property_, False) for property_ in further))
    for property_ in further:
        outcomes.append(_try_next(property_, function, outcomes, begin))
    return tuple(outcomes)


def _try_next(
    property_: Property, function: Callable, outcomes: Sequence[Outcome], begin: Begin | None
) -> Outcome:
    """The outcome of the next property after some outcomes."""
    if begin is None:
        return try_property(property_, function)
    return try_property(property_, function, begin=partial(begin, outcomes))


def _answers(property_: Property, function: Callable) -> bool:
    """Whether a function returns in any case something that can be compared."""
    for case in property_.cases():
        error = failure(property_, function, case)
        if error is None or isinstance(error, AssertionError):
            return True
    return False


def holds(exercise: Exercise, implementation: Callable) -> bool:
    """Whether every property holds; stops at the first that does not."""
    return all(failing_case(property_, implementation) is None for property_ in exercise.properties)


def make_readable(text: str) -> str:
    """A text of readable length, control characters escaped."""
    return visible(text[:LONGEST_TEXT])


def reply_of(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """The outcomes in plain dicts, lists and texts."""
    return {"outcomes": [_plain_outcome(outcome) for outcome in outcomes]}


def _plain_outcome(outcome: Outcome) -> dict[str, Any]:
    """An outcome without its property."""
    return {
        "held": outcome.held,
        "problem": outcome.problem,
        "counterexample": outcome.counterexample,
        "mistake": outcome.mistake,
        "kind": outcome.kind,
    }


def report_of(exercise: Exercise, reply: dict[str, Any]) -> Report:
    """The report from a reply of `reply_of`, or one that says why there is no such reply.

    If the process was ended, the outcomes until then count. Names, statements and points are not
    taken from the reply.
    """
    outcomes: list[Outcome] = []
    try:
        problem = make_readable(reply["failed"])
        sent = reply.get("outcomes", ()) if problem else reply["outcomes"]
        pairs = zip(exercise.properties, sent, strict=not problem)
        outcomes = [_outcome_of(property_, plain) for property_, plain in pairs]
        if "trying" in reply and problem:
            trying = make_readable(reply["trying"])
            problem += f"\nit was tried with {trying}"
            if not _is_first_case(exercise, len(outcomes), trying):
                problem += "; smaller cases were right"
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        problem = f"its process sent no reply: {error}"
    for property_ in exercise.properties[len(outcomes) :]:
        outcomes.append(Outcome(property_, False, problem))
        problem = ""  # it is said once
    return Report(exercise, exercise.name, tuple(outcomes))


def _is_first_case(exercise: Exercise, number: int, trying: str) -> bool:
    """Whether this was the first case of the property of this number, before which none was."""
    return trying == make_readable(str(exercise.properties[number].cases()[0]))


def _outcome_of(property_: Property, plain: dict[str, Any]) -> Outcome:
    """The outcome of a property from a plain dict, whose texts may be anything."""
    return Outcome(
        property_,
        plain["held"] is True,
        make_readable(plain["problem"]),
        make_readable(plain["counterexample"]),
        make_readable(plain["mistake"]),
        make_readable(plain["kind"]),
    )
