"""One property tried on one implementation: the smallest case that fails, and why."""

from collections.abc import Callable, Sequence
from copy import deepcopy
from typing import Any

from numpy_cae.verify.checks.calls import is_value_and_pullback
from numpy_cae.verify.checks.messages import (
    LONGEST_ARGUMENTS,
    LONGEST_TEXT,
    WORTH_PRINTING,
    as_text,
    error_text,
    file_of,
    texts_that_differ,
)
from numpy_cae.verify.checks.mismatch import (
    ALTERED,
    DTYPE,
    NUMBER,
    OVERWRITTEN,
    Mismatch,
    kind_and_subject,
)
from numpy_cae.verify.operations.case import ORDINARY, Case, simplest_case
from numpy_cae.verify.operations.counterexample import failure, first_failure, smallest_case
from numpy_cae.verify.operations.diagnosis import likely_mistake
from numpy_cae.verify.operations.operation_catalogue import example_call
from numpy_cae.verify.operations.property import Outcome, Property


class _Recorder:
    """An implementation with the arguments of its last call, or of the last pullback called.

    `upstreams` are what the pullbacks were given since that call.
    """

    def __init__(self, implementation: Callable) -> None:
        self.implementation = implementation
        self.arguments: tuple = ()
        self.upstreams: list = []

    def __call__(self, *arguments: Any) -> Any:
        arguments_of_call = deepcopy(arguments)
        self.arguments = arguments_of_call
        self.upstreams = []
        returned = self.implementation(*arguments)
        if not is_value_and_pullback(returned):
            return returned
        value, pullback = returned

        def record_pullback(*upstream: Any) -> Any:
            self.arguments = arguments_of_call
            self.upstreams += deepcopy(upstream)
            return pullback(*upstream)

        return value, record_pullback


UNSTEADY = "called again with the same arguments, it returns something else"


def try_property(
    property_: Property,
    implementation: Callable,
    shrink: bool = True,
    begin: Callable[[Case], None] | None = None,
) -> Outcome:
    """Test an implementation for a property on random cases, the same in every run.

    The counterexample is the smallest case that fails, or without `shrink` the first one. `begin`
    is called with each case before it is tried.
    """
    failed = first_failure(property_, implementation, begin)
    if failed is None:
        return Outcome(property_, held=True)
    case, first_error = failed
    recorder = _Recorder(implementation)
    error = failure(property_, recorder, case)
    if error is not None and shrink and not isinstance(error, NotImplementedError):
        case = smallest_case(property_, implementation, case, kind_and_subject(error))
        recorder = _Recorder(implementation)
        error = failure(property_, recorder, case)
    if error is None:
        first = _describe_problem(property_, first_error, implementation, case)
        problem = f"{UNSTEADY}; at first: {first}"
        return Outcome(property_, False, problem, str(case))
    return Outcome(
        property_,
        held=False,
        problem=_describe_problem(property_, error, implementation, case),
        counterexample="\n".join(_describe_example(property_, case, recorder, error)),
        mistake=_describe_mistake(property_, implementation, error, case),
        kind=kind_and_subject(error)[0],
        crashed=not isinstance(error, AssertionError),
    )


def _describe_problem(
    property_: Property, error: BaseException, implementation: Callable, case: Case
) -> str:
    """What is wrong: the mismatch, or the error with its line."""
    if isinstance(error, AssertionError):
        return str(error)[:LONGEST_TEXT]
    is_own = property_.comparison is not None and property_.comparison.operation.is_own
    problem = error_text(error, file_of(implementation), is_file_named=is_own)
    if isinstance(error, RecursionError | MemoryError):
        problem += f"\nit runs out of depth or memory with {case}"
        if case not in (property_.cases()[0], simplest_case(property_.sizes)):
            problem += "; smaller cases were right"
    return problem


MISTAKE_OF_KIND = {
    ALTERED: "That array is written to, as by -= or out=: a new one is needed.",
    DTYPE: "An array in it has a dtype of its own, such as np.zeros(n), which is float64.",
    OVERWRITTEN: "The next call changes what one returned: it is kept in one array or list.",
}
"""The likely mistake where the kind of a mismatch tells it."""
C_ORDER = "Memory in another order is read as if it were in C order, as strides and reshape may do."


def _describe_mistake(
    property_: Property, implementation: Callable, error: BaseException, case: Case
) -> str:
    """The likely mistake, or ""."""
    kind, _ = kind_and_subject(error)
    of_kind = MISTAKE_OF_KIND.get(kind, "")
    mistake = ""
    if isinstance(error, AssertionError | ValueError | IndexError):  # as planted bugs may raise
        mistake = likely_mistake(property_, implementation, of_kind)
    if mistake or of_kind:
        return mistake or of_kind
    if property_.name == "strides" and kind == NUMBER:
        if failure(property_, implementation, case.with_option("layout", ORDINARY)) is None:
            return C_ORDER
    return ""


def check_property(
    property_: Property, function: Callable, crashes: set[str] | None = None
) -> None:
    """Raise unless an implementation has a property.

    Parameters
    ----------
    property_ : Property
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
    outcome = try_property(property_, function)
    if outcome.held:
        return
    lines = [property_.statement, outcome.problem, outcome.counterexample, outcome.mistake]
    if outcome.crashed and crashes is not None:
        if outcome.problem in crashes:
            lines = [f"as in an earlier test, {outcome.problem}"]
        crashes.add(outcome.problem)
    raise AssertionError("\n".join(line for line in lines if line))


def _describe_example(
    property_: Property, case: Case, recorder: _Recorder, error: BaseException
) -> list[str]:
    """The arguments of the last call, and what it should return; or the call of `example`."""
    arguments = property_.arguments(case)
    if set(arguments) == {"seed"}:  # what the function is tried with is not drawn
        return []
    if len(recorder.arguments) == len(arguments):
        arguments = dict(zip(arguments, recorder.arguments, strict=True))
        arguments |= _name_upstreams(property_, recorder.upstreams)
    lines = [f"{name} = {as_text(argument)}" for name, argument in arguments.items()]
    if sum(map(len, lines)) > LONGEST_ARGUMENTS:
        lines = [example_call(property_, case)]
    return [str(case), *lines, *_describe_result(error)]


UPSTREAMS_OF_LINEARITY = ("dy", "dy'", "2 dy - 3 dy'")
"""The names of the upstream gradients that "linearity" gives, in their order."""


def _name_upstreams(property_: Property, upstreams: Sequence) -> dict[str, Any]:
    """The last upstream gradient by name, or the three of "linearity"."""
    if property_.name == "linearity" and len(upstreams) == len(UPSTREAMS_OF_LINEARITY):
        return dict(zip(UPSTREAMS_OF_LINEARITY, upstreams, strict=True))
    return {"upstream gradient": upstreams[-1]} if upstreams else {}


def _describe_result(error: BaseException) -> list[str]:
    """The result and what it should be, if they are small arrays."""
    if not isinstance(error, Mismatch) or error.result is None:
        return []
    if error.result.size > WORTH_PRINTING:
        return []
    result, expected = texts_that_differ(error.result, error.expected)
    return [f"{error.subject.removeprefix('the ')}: {result}", f"  expected: {expected}"]
