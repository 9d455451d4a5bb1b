"""One property tried on one implementation, with the smallest case in which it fails."""

from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, field, replace

from numpy_cae.verify.checks import written as writing
from numpy_cae.verify.checks.call import is_pair
from numpy_cae.verify.checks.mismatch import ALTERED, DTYPE, OVERWRITTEN, what_failed
from numpy_cae.verify.checks.written import LONGEST_TEXT, error_text, file_of, written
from numpy_cae.verify.operations.case import SEEDS_TRIED, Case, Sizes
from numpy_cae.verify.operations.catalogue import example_call
from numpy_cae.verify.operations.diagnosis import likely_mistake
from numpy_cae.verify.operations.property import Outcome, Property, failing_case, failure

C_ORDER = "Memory in another order is read as if it were in C order, as strides and reshape may do."
OF_KIND = {ALTERED: "That array is written to, as by -= or out=: a new one is needed."}
OF_KIND[DTYPE] = "An array in it has a dtype of its own, such as np.zeros(n), which is float64."
OF_KIND[OVERWRITTEN] = "Results are kept in one array: the next call overwrites what one returns."
"""OF_KIND: the likely mistake where the kind of a mismatch tells it."""
UNSTEADY = "called again with the same arguments, it returns something else"
MAX_SHRINKS = 150
"""MAX_SHRINKS: so many simpler cases are tried to find a smaller counterexample."""


@dataclass
class Recorder:
    """An implementation that records its last call, and what the pullbacks were given since."""

    implementation: Callable
    arguments: tuple | None = None
    upstreams: list = field(default_factory=list)

    def __call__(self, *arguments):
        given = deepcopy(arguments)
        self.arguments = given
        self.upstreams = []
        returned = self.implementation(*arguments)
        if not is_pair(returned):
            return returned

        def recorded_pullback(*upstream):
            self.arguments = given
            self.upstreams += deepcopy(upstream)
            return returned[1](*upstream)

        return returned[0], recorded_pullback


def try_property(
    tried: Property,
    implementation: Callable,
    shrink: bool = True,
    begin: Callable[[Case], None] = lambda case: None,
) -> Outcome:
    """Test an implementation for a property on random cases, the same in every run.

    The counterexample is the smallest case that fails, or without `shrink` the first one. `begin`
    is called with each case before it is tried.
    """
    case = failing_case(tried, implementation, begin)
    if case is None:
        return Outcome(tried, held=True)
    last = Recorder(implementation)
    error = failure(tried, last, case)
    if error is not None and shrink and not isinstance(error, NotImplementedError):
        case = _smallest(tried, implementation, case, what_failed(error))
        error = failure(tried, last, case)
    failed = Outcome(tried, False, UNSTEADY, str(case))
    if error is None:
        return failed
    kind, _ = what_failed(error)
    crashed = not isinstance(error, AssertionError)
    problem = error_text(error, file_of(implementation)) if crashed else str(error)[:LONGEST_TEXT]
    if isinstance(error, RecursionError | MemoryError):
        problem += f"\nit runs out of depth or memory with {case}; smaller cases were right"
    is_like_bugs = isinstance(error, AssertionError | ValueError | IndexError)
    of_kind = OF_KIND.get(kind, "")
    mistake = likely_mistake(tried, implementation, of_kind) if is_like_bugs else of_kind
    mistake = mistake or of_kind or C_ORDER * (tried.name == "strides" and not crashed)
    example = "\n".join(_described(tried, case, last, error))
    why = {"problem": problem, "counterexample": example, "mistake": mistake, "kind": kind}
    return replace(failed, **why, crashed=crashed)


def _smallest(
    tried: Property, implementation: Callable, case: Case, failed: tuple[str, str]
) -> Case:
    """A case that fails in the same way; making any one size or class simpler would pass."""
    count = 0
    while count < MAX_SHRINKS:
        for simpler in _simpler(case, tried.sizes):
            count += 1
            error = failure(tried, implementation, simpler)
            if error is not None and what_failed(error) == failed:
                case = simpler
                break
        else:
            break
    return case


def _simpler(case: Case, sizes: Sizes) -> Iterator[Case]:
    """The case with one size, class or seed made simpler, largest simplifications first."""
    for number, (name, size) in enumerate(case.sizes):
        for option in sizes[name][: sizes[name].index(size)]:
            changed = (*case.sizes[:number], (name, option), *case.sizes[number + 1 :])
            yield Case(changed, case.seed)
    for seed in range(min(case.seed, SEEDS_TRIED)):
        yield Case(case.sizes, seed)


def check_property(stated: Property, function: Callable, crashes: set[str] | None = None) -> None:
    """Raise unless an implementation has a property.

    Parameters
    ----------
    stated : Property
        One of `properties`; in a test file, `pytest.mark.parametrize` makes a test of each.
    function : callable
        The implementation.
    crashes : set of str, optional
        The errors that were already shown for other properties: they are not shown in full again.

    Raises
    ------
    AssertionError
        With the statement, what is wrong, the smallest counterexample and the likely mistake.

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
    message = [stated.statement, outcome.problem, outcome.counterexample, outcome.mistake]
    if outcome.crashed and crashes is not None:
        if outcome.problem in crashes:
            message = [f"as in an earlier test, {outcome.problem}"]
        crashes.add(outcome.problem)
    if not outcome.held:
        raise AssertionError("\n".join(filter(None, message)))


def _described(tried: Property, case: Case, last: Recorder, error: BaseException) -> Iterator[str]:
    """The arguments of the last call, and what it should return; or the call of `example`."""
    shown = tried.arguments(case)
    upstreams = last.upstreams
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
    is_short = sum(map(len, lines)) <= writing.LONGEST_ARGUMENTS
    yield from lines if is_short else [example_call(tried, case)]
    result = getattr(error, "result", None)
    if result is not None and result.size <= writing.WORTH_PRINTING:
        result, right = writing.written_apart(result, error.expected)
        yield f"{error.subject.removeprefix('the ')}: {result}"
        yield f"  expected: {right}"
