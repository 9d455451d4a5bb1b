"""One property tried on one implementation, with the smallest case in which it fails."""

import pickle
import random
import re
import warnings
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.verify.checks.call import is_pair
from numpy_cae.verify.checks.notes import conclude, file_of, noted
from numpy_cae.verify.checks.written import (
    LONGEST_ARGUMENTS,
    LONGEST_TEXT,
    WORTH_PRINTING,
    error_text,
    written,
    written_apart,
)
from numpy_cae.verify.operations.case import Case, example_call, smallest
from numpy_cae.verify.operations.catalogue import Exercise, find_exercise
from numpy_cae.verify.operations.diagnosis import likely_mistake
from numpy_cae.verify.operations.property import Mismatch, Outcome, Property, case_of, right_results

WATCHED = 4
"""One case in WATCHED is checked for changes of global state, which is slow."""


@dataclass
class Recorder:
    """An implementation that records its last call, and what the pullbacks were given since."""

    implementation: Callable
    arguments: tuple | None = None
    upstreams: list = field(default_factory=list)

    def __call__(self, *arguments):
        given = deepcopy(arguments)
        self.arguments, self.upstreams = given, []
        returned = self.implementation(*arguments)
        if not is_pair(returned):
            return returned

        def recorded_pullback(*upstream):
            self.arguments = given
            self.upstreams += deepcopy(upstream)
            return returned[1](*upstream)

        return returned[0], recorded_pullback


@dataclass(frozen=True)
class Example:
    """The arguments of a case and, for an operation, the right results."""

    arguments: dict[str, object]
    upstream: np.ndarray | float | None = None
    value: np.ndarray | float | None = None
    gradients: dict[str, np.ndarray] = field(default_factory=dict)


def example(name: str | Exercise, seed: int, **sizes: int | str) -> Example:
    """The arguments of a counterexample: a report prints the call of this function.

    Parameters
    ----------
    name : str or Exercise
        An operation of `numpy_cae.ops`, "tied_layer", or an exercise.
    seed : int
    **sizes : int or str
        The sizes of the arrays, such as frames=2, and classes such as values="ties".

    Returns
    -------
    Example
        With `arguments` by name and, for an operation, the `upstream` gradient and the `value` and
        `gradients` of the definition.

    Raises
    ------
    ValueError
        If there is no such operation, or a size is missing or unknown.

    Examples
    --------
    >>> from numpy_cae import verify
    >>> case = verify.example("max_pool", seed=0, batch=1, frames=2, channels=1, values="ties")
    >>> case.arguments["x"].ravel().tolist(), case.value.ravel().tolist()
    ([2.0, 1.0], [2.0])
    """
    exercise = find_exercise(name)
    first, case = exercise.properties[0], case_of(exercise.properties, seed, sizes)
    arguments, operation = first.arguments(case), first.definition
    if operation is None:
        return Example(arguments)
    dy, right = right_results(operation, case, arguments)
    value, *gradients = right.values()
    named = dict(zip(operation.differentiated, gradients, strict=True))
    return Example(arguments, dy, value, named)


def try_property(tried: Property, implementation: Callable, shrink: bool = True) -> Outcome:
    """Test an implementation for a property on random cases, the same in every run.

    The counterexample is the smallest case that fails, or without `shrink` the first one.
    """
    notes: list[str] = []
    case = failing_case(tried, implementation, notes)
    if case is None:
        return Outcome(tried, held=True, notes=tuple(notes))
    last = Recorder(implementation)
    error = failure(tried, last, case)
    found = _finding(error)
    if shrink and not isinstance(error, NotImplementedError | None):
        again = lambda case: _finding(failure(tried, implementation, case)) == found  # noqa: E731
        case = smallest(case, tried.sizes, again)
        error = failure(tried, last, case)
    if error is None:  # it fails in one call and not in the next
        problem = "called again with the same arguments, it returns something else"
        return Outcome(tried, False, problem, str(case), "", case, tuple(notes))
    problem = str(error)[:LONGEST_TEXT]
    if not isinstance(error, AssertionError):
        problem = error_text(error, file_of(implementation))
    example = "\n".join(_described(tried, case, last, error))
    mistake = ""
    if isinstance(error, AssertionError | ValueError | IndexError):  # as planted bugs raise
        mistake = likely_mistake(tried, implementation)
    return Outcome(tried, False, problem, example, mistake, case, tuple(notes))


def _finding(error: Exception | None) -> tuple[type, str]:
    """What failed, by the type of an error and its words before the first number or shape.

    A smaller case counts only if the same fails in it.
    """
    words = str(error) if isinstance(error, AssertionError) else ""
    return type(error), re.split(r"[-\d(]", words)[0]


def failing_case(
    tried: Property, implementation: Callable, notes: list[str] | None = None
) -> Case | None:
    """The first case in which a property does not hold, or None; its warnings become notes."""
    notes = [] if notes is None else notes
    cases = tried.cases()
    return next((c for c in cases if failure(tried, implementation, c, notes) is not None), None)


def check_property(stated: Property, function: Callable) -> None:
    """Raise unless an implementation has a property.

    Parameters
    ----------
    stated : Property
        One of `properties`; in a test file, `pytest.mark.parametrize` makes a test of each.
    function : callable
        The implementation.

    Raises
    ------
    AssertionError
        With the statement, what is wrong, the smallest counterexample and the likely mistake.

    Warns
    -----
    RuntimeWarning
        If the property holds, but the implementation gives a warning, such as an overflow.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> value, gradient, *others = verify.properties("tanh")
    >>> wrong = lambda x: (np.tanh(x), lambda dy: dy * (1 - x * x))
    >>> verify.check_property(value, wrong)
    >>> verify.check_property(gradient, wrong)
    Traceback (most recent call last):
    AssertionError: the pullback's gradient for x is that of the definition
        ...
    """
    outcome = try_property(stated, function)
    message = (stated.statement, outcome.problem, outcome.counterexample, outcome.mistake)
    conclude([] if outcome.held else [*filter(None, message)], outcome.notes)


def failure(
    tried: Property, implementation: Callable, case: Case, notes: list[str] | None = None
) -> Exception | None:
    """The error that a check raises in a case, or None; warnings become notes."""
    try:
        with noted([] if notes is None else notes, file_of(implementation)):
            if tried.name == "purity" and case.seed % WATCHED == 0:
                call_keeping_state(tried.check, implementation, case)
            else:
                tried.check(implementation, case)
    except Exception as error:
        return error
    except SystemExit:
        return RuntimeError("it calls sys.exit")
    return None


def _described(tried: Property, case: Case, last: Recorder, error: Exception) -> Iterator[str]:
    """The arguments of the last call, and what it should return; or the call of `example`."""
    shown, upstreams = tried.arguments(case), last.upstreams
    if set(shown) == {"seed"}:  # what the function is tried with is not drawn
        return
    names = ("dy", "dy'", "2 dy - 3 dy'")
    if last.arguments is not None and len(last.arguments) == len(shown):
        shown = dict(zip(shown, last.arguments, strict=True))
        if tried.name == "linearity" and len(upstreams) == len(names):
            shown |= dict(zip(names, upstreams, strict=True))
        elif upstreams:
            shown["upstream gradient"] = upstreams[-1]
    yield str(case)
    lines = [f"{name} = {written(argument)}" for name, argument in shown.items()]
    is_short = sum(map(len, lines)) <= LONGEST_ARGUMENTS
    yield from lines if is_short else [example_call(tried.operation, case)]
    if isinstance(error, Mismatch) and error.result.size <= WORTH_PRINTING:
        result, right = written_apart(error.result, error.expected)
        yield f"{error.what.removeprefix('the ')}: {result}"
        yield f"  expected: {right}"


def call_keeping_state(function: Callable, *arguments: object) -> None:
    """Call a function; raise an AssertionError if it changes global state.

    Before the call the state is made unusual, so that setting the usual state again is noticed.
    """
    shared = np.random.get_bit_generator()
    numbers, standard = shared.state, random.getstate()
    shared.random_raw(), random.random()
    quiet = np.errstate(all="call", call=lambda *error: None)
    try:
        with warnings.catch_warnings(), np.printoptions(precision=17), quiet:
            warnings.simplefilter("default", ImportWarning)
            before = _state()
            function(*arguments)
            changed = [what for what, now in _state().items() if now != before[what]]
    finally:
        shared.state = numbers
        random.setstate(standard)
    if changed:
        raise AssertionError(f"it changes {', '.join(changed)}: the whole program shares that")


def _state() -> dict[str, object]:
    return {
        "np.seterr": np.geterr(),
        "np.set_printoptions": np.get_printoptions(),
        "the state of np.random": pickle.dumps(np.random.get_bit_generator().state),
        "the state of random": random.getstate(),
        "the filters of warnings": list(warnings.filters),
    }
