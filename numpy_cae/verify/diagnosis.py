"""The likely mistake of an implementation that fails: the planted bug that behaves the same.

The calls of failing examples are recorded and repeated with each planted bug of the operation. A
bug is named only if it reproduces what the implementation did, in these calls and at further
random cases, and the right operation does not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.verify.case import Case
from numpy_cae.verify.operation import OPERATIONS
from numpy_cae.verify.planted_bugs import bugs_of, right_operation
from numpy_cae.verify.property import Property, drawn_upstream

MAX_RECORDED = 400
MAX_REPEATED = 40
GENERAL_CASES = 8


@dataclass
class CallRecord:
    """One call of an operation, or of a pullback that the call number `of_call` returned."""

    of_call: int
    arguments: tuple
    arguments_after: tuple = ()
    result: tuple = ()
    raised: type | None = None
    is_pullback: bool = False


@dataclass
class Recorder:
    """An implementation that records its calls."""

    implementation: Callable
    records: list[CallRecord] = field(default_factory=list)
    calls: int = 0

    def __call__(self, *arguments):
        number, self.calls = self.calls, self.calls + 1
        record = CallRecord(number, _copies(arguments))
        returned = self._recorded(record, self.implementation, arguments)
        if not (isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1])):
            return returned
        value, pullback = returned

        def recorded_pullback(*upstream):
            record = CallRecord(number, _copies(upstream), is_pullback=True)
            return self._recorded(record, pullback, upstream)

        return value, recorded_pullback

    def _recorded(self, record: CallRecord, function: Callable, arguments: tuple):
        if len(self.records) < MAX_RECORDED:
            self.records.append(record)
        try:
            with np.errstate():  # a student's np.seterr ends here
                returned = function(*arguments)
        except SystemExit:
            record.raised = RuntimeError
            raise RuntimeError("it calls sys.exit") from None
        except Exception as error:
            record.raised = type(error)
            raise
        record.arguments_after = _copies(arguments)
        record.result = _copies(_arrays(returned, record.is_pullback))
        return returned

    def reproduced_by(self, other: Callable, only: int | None = None) -> bool:
        """Whether another implementation, called the same, does the same.

        Of the gradients, `only` one is compared if it is given.
        """
        repeated = {record.of_call for record in self.records if record.is_pullback}
        repeated |= set(range(MAX_REPEATED))
        pullbacks: dict[int, Callable] = {}
        for record in self.records:
            if record.of_call not in repeated:
                continue
            arguments = _copies(record.arguments)
            try:
                function = pullbacks[record.of_call] if record.is_pullback else other
                with np.errstate(all="ignore"):
                    returned = function(*arguments)
            except Exception as error:
                return record.raised is type(error)
            if record.raised:
                return False
            if not record.is_pullback:
                pullbacks[record.of_call] = returned[1]
            ours, theirs = record.result, _arrays(returned, record.is_pullback)
            if record.is_pullback and only is not None:
                ours, theirs = ours[only : only + 1], theirs[only : only + 1]
            if not _equal(ours, theirs) or not _equal(record.arguments_after, arguments):
                return False
        return bool(self.records)


def likely_mistake(stated: Property, implementation: Callable, failed: list[Recorder]) -> str:
    """The sentence of the planted bug that behaves as an implementation does, or "".

    The property does not hold; `failed` has the calls of failing examples.
    """
    bugs = bugs_of(stated.operation)
    if not bugs:
        return ""
    only = None
    if stated.name.startswith(("gradient for", "adjoint in")):
        names = OPERATIONS[stated.operation].differentiated
        only = names.index(stated.name.rpartition(" ")[2])
    right = right_operation(stated.operation)
    if any(recorder.reproduced_by(right, only) for recorder in failed):
        return ""
    pulls = stated.name != "value"
    general = [_recorded_at(stated, implementation, seed, pulls) for seed in range(GENERAL_CASES)]
    alike = [
        bug
        for bug in bugs
        if all(recorder.reproduced_by(bug.function(), only) for recorder in [*failed, *general])
    ]
    if len(alike) > 1:  # compare all gradients, not only the one that is wrong here
        general = [_recorded_at(stated, implementation, seed) for seed in range(GENERAL_CASES)]
        alike.sort(key=lambda bug: -sum(r.reproduced_by(bug.function()) for r in general))
    return alike[0].sentence if alike else ""


def _recorded_at(stated: Property, function: Callable, seed: int, pulls: bool = True) -> Recorder:
    """One call at a random case, with a call of the pullback if `pulls`."""
    rng = np.random.default_rng(seed)
    sizes = tuple((name, int(rng.choice(options))) for name, options in stated.sizes.items())
    recorder, case = Recorder(function), Case(sizes, seed)
    try:
        value, pullback = recorder(*stated.arguments(case).values())
        if pulls:
            pullback(drawn_upstream(case, value))
    except Exception:  # it is recorded
        pass
    return recorder


def _arrays(returned, is_pullback: bool) -> tuple:
    """The gradients that a pullback returned, or the value that a call returned."""
    if is_pullback:
        return tuple(returned) if isinstance(returned, tuple | list) else (returned,)
    return (returned[0],) if isinstance(returned, tuple) and returned else (returned,)


def _copies(arguments: tuple) -> tuple:
    return tuple(a.copy(order="K") if isinstance(a, np.ndarray) else a for a in arguments)


def _equal(ours: tuple, theirs: tuple) -> bool:
    if len(ours) != len(theirs):
        return False
    for one, other in zip(ours, theirs, strict=True):
        if not isinstance(one, np.ndarray | np.generic | float | int):
            return False
        one, other = np.asarray(one), np.asarray(other)
        if one.shape != other.shape or one.dtype != other.dtype:
            return False
        if not np.allclose(one, other, rtol=1e-9, atol=1e-13, equal_nan=True):
            return False
    return True
