"""One property tried on one implementation, with the smallest case in which it fails."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.verify.case import (
    WORTH_PRINTING,
    Case,
    case_of,
    drawn_cases,
    example_call,
    smallest,
    written,
)
from numpy_cae.verify.diagnosis import likely_mistake
from numpy_cae.verify.operation import Operation
from numpy_cae.verify.property import (
    Outcome,
    Property,
    agrees,
    copied,
    copies,
    differentiated,
    drawn_upstream,
)

WORTH_A_RESULT = 12


@dataclass
class Call:
    """One call of an operation, and the last one of the pullback that it returned."""

    arguments: tuple
    value: object = None
    upstream: tuple = ()
    pulled: object = None


@dataclass
class Recorder:
    """An implementation that remembers its last call."""

    implementation: Callable
    last: Call | None = None

    def __call__(self, *arguments):
        call = self.last = Call(_copies(arguments))
        returned = _called(self.implementation, arguments)
        if not (isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1])):
            return returned
        value, pullback = returned
        call.value = np.copy(value)

        def recorded_pullback(*upstream):
            self.last = Call(call.arguments, call.value, _copies(upstream))
            pulled = _called(pullback, upstream)
            self.last.pulled = _copies(pulled if isinstance(pulled, tuple | list) else (pulled,))
            return pulled

        return value, recorded_pullback


@dataclass(frozen=True)
class Example:
    """The arguments of a case; of an operation also what the definition makes of them."""

    arguments: dict[str, object]
    upstream: np.ndarray | float | None = None
    value: np.ndarray | float | None = None
    gradients: dict[str, np.ndarray] = field(default_factory=dict)


def example_of(
    properties: Sequence[Property], seed: int, sizes: Mapping[str, int | str]
) -> Example:
    """The case of an operation with these sizes; a ValueError if one is missing or unknown."""
    case, operation = case_of(properties, seed, sizes), properties[0].definition
    arguments = properties[0].arguments(case)
    if operation is None:
        return Example(arguments)
    value, pullback = operation.reference(*copies(arguments))
    dy = drawn_upstream(case, value)
    return Example(arguments, dy, value, differentiated(operation, pullback(copied(dy))))


def try_property(
    tried: Property,
    implementation: Callable,
    examples: int | None = None,
    shrink: bool = True,
) -> Outcome:
    """Test an implementation for a property on drawn cases, the same ones every time.

    Parameters
    ----------
    tried : Property
    implementation : callable
        In the form of the operation in `numpy_cae.ops`.
    examples : int, optional
        By default the number that the property states.
    shrink : bool
        Whether to look for the smallest counterexample rather than take the first.
    """
    for case in drawn_cases(tried, examples or tried.examples):
        error, _ = _failure(tried, implementation, case)
        if error is not None:
            break
    else:
        return Outcome(tried, held=True)
    kind = type(error)
    if shrink and kind is not NotImplementedError:
        case = smallest(case, tried, lambda c: _fails_by(kind, tried, implementation, c))
    error, call = _failure(tried, implementation, case)
    if error is None:  # it fails in one call and not in the next
        return Outcome(tried, False, "it does not do the same when called again", str(case))
    problem = str(error)
    if not isinstance(error, AssertionError):
        problem = f"{type(error).__name__}: {error}{_line(error, implementation)}"
    mistake = likely_mistake(tried, implementation)
    return Outcome(tried, False, problem, "\n".join(_described(tried, case, call)), mistake)


def _failure(tried: Property, implementation: Callable, case: Case):
    """What a check raises in a case, if anything, and the last call before it."""
    recorder = Recorder(implementation)
    try:
        with np.errstate(all="ignore"):
            tried.check(recorder, case)
    except Exception as error:
        return error, recorder.last
    return None, recorder.last


def _fails_by(kind: type, tried: Property, implementation: Callable, case: Case) -> bool:
    return type(_failure(tried, implementation, case)[0]) is kind


def _called(function: Callable, arguments: tuple):
    try:
        with np.errstate():  # a student's np.seterr ends here
            return function(*arguments)
    except SystemExit:
        raise RuntimeError("it calls sys.exit") from None


def _described(tried: Property, case: Case, call: Call | None) -> Iterator[str]:
    """The case, the arguments and the results; if they are long, a call to get them."""
    yield str(case)
    arguments = tried.arguments(case)
    operation = tried.definition
    if call is None or operation is None or len(call.arguments) != len(arguments):
        yield from _printed(arguments, tried, case)
        return
    given = dict(zip(arguments, call.arguments, strict=True))
    if call.upstream:
        given["upstream gradient"] = call.upstream[0]
    yield from _printed(given, tried, case)
    if call.value is not None:
        for what, found, expected in _results(operation, call):
            small = all(np.size(a) <= WORTH_A_RESULT for a in (found, expected))
            if small and not agrees(
                operation.alike(given, found), operation.alike(given, expected)
            ):
                yield f"{what}: {written(found)}"
                yield f"  expected: {written(expected)}"


def _printed(arguments: dict[str, object], tried: Property, case: Case) -> Iterator[str]:
    if sum(a.size for a in arguments.values() if isinstance(a, np.ndarray)) > WORTH_PRINTING:
        yield example_call(tried.operation, case)
        return
    for argument, value in arguments.items():
        yield f"{argument} = {written(value)}"


def _results(operation: Operation, call: Call) -> Iterator[tuple[str, object, object]]:
    """Each result of a call beside that of the definition."""
    with np.errstate(all="ignore"):
        value, pullback = operation.reference(*_copies(call.arguments))
        yield "value", call.value, np.asarray(value)
        if call.upstream and call.pulled is not None:
            expected = pullback(copied(call.upstream[0]))
            expected = expected if isinstance(expected, tuple) else (expected,)
            for name, one, other in zip(
                operation.differentiated, call.pulled, expected, strict=False
            ):
                if isinstance(one, np.ndarray | np.generic):
                    yield f"gradient for {name}", one, other


def _copies(values) -> tuple:
    return tuple(a.copy(order="K") if isinstance(a, np.ndarray) else a for a in values)


def _line(error: Exception, implementation: Callable) -> str:
    """The last line of the implementation's own file that an exception came through."""
    code = getattr(inspect.unwrap(implementation), "__code__", None)
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if code and frame.filename == code.co_filename]
    return f" (line {lines[-1]})" if lines else ""
