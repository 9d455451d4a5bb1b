"""The likely mistake of an implementation that fails: a wrong operation that does the same.

The implementation, the right operation, each planted bug and each other convention are called with
the same random cases. A mistake is named only if the wrong operation does in every case what the
implementation does, wherever either of them can show, and the right operation does not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from numpy_cae.verify.case import Case, drawn_cases
from numpy_cae.verify.convention import VARIANTS
from numpy_cae.verify.layout import LAYOUTS
from numpy_cae.verify.operation import Operation
from numpy_cae.verify.planted_bugs import bugs_of
from numpy_cae.verify.property import (
    UPSTREAM,
    Property,
    copied,
    copies,
    differentiated,
    drawn_upstream,
    in_float32,
)

CASES = 39
SEVERAL = 2
SHOWN_BY = {
    "value": ("value",),
    "purity": ("altered",),
    "independence": ("again",),
    "dtype": ("value", "gradient", "float32"),
    "strides": ("of views",),
    "upstream default": ("by default",),
}
"""By property, how the keys begin of what shows that it does not hold; else value and gradients."""

Observation = dict[str, object]


@dataclass
class Diagnosis:
    """What an implementation does, compared with what wrong operations do."""

    operation: Operation
    implementation: Callable

    def mistake(self, stated: Property) -> str:
        """The sentence on the mistake because of which a property does not hold, or ""."""
        starts = SHOWN_BY.get(stated.name, ("value", "gradient"))
        if stated.name.startswith(("gradient for", "adjoint in")):
            starts = (f"gradient for {stated.name.rpartition(' ')[2]}",)
        wrong = sum(bool(_differing(a, b, starts)) for a, b in self._observed)
        if wrong < SEVERAL:
            return ""
        explained = {
            sentence: len(touched)
            for sentence, touched in self._reproducing.items()
            if any(key.startswith(starts) for key in touched)
            and all(key in touched for a, b in self._observed for key in _differing(a, b, starts))
        }
        return max(explained, key=explained.__getitem__, default="")

    @cached_property
    def _cases(self) -> list[Case]:
        sizes = {
            name: options if isinstance(options[0], str) else options[-3:]  # where more can show
            for name, options in {**self.operation.sizes, **UPSTREAM}.items()
        }
        name, arguments = self.operation.name, self.operation.arguments
        return list(drawn_cases(Property(name, "diagnosis", "", print, arguments, sizes), CASES))

    @cached_property
    def _observed(self) -> list[tuple[Observation, Observation]]:
        """What the implementation and the right operation do in each case."""
        both = self.implementation, self.operation.reference
        return [tuple(observe(f, self.operation, case) for f in both) for case in self._cases]

    @cached_property
    def _reproducing(self) -> dict[str, set[str]]:
        """The wrong operations that do the same, each with the keys of what they do wrong."""
        wrong = [(bug.sentence, bug.function()) for bug in bugs_of(self.operation.name)]
        wrong += [
            (f"another convention, which may be allowed: {variant.sentence}", variant.reference)
            for variant in VARIANTS.get(self.operation.name, ())
        ]
        found = {sentence: self._touched(function) for sentence, function in wrong}
        return {sentence: touched for sentence, touched in found.items() if touched}

    def _touched(self, wrong: Callable) -> set[str]:
        """The keys of what a wrong operation does wrong, if the implementation does all of it."""
        touched: set[str] = set()
        kept = []
        for case, (student, right) in zip(self._cases, self._observed, strict=True):
            kept.append((student, observe(wrong, self.operation, case)))
            touched |= _differing(kept[-1][1], right)
            if any(_differing(*pair) & touched for pair in kept):
                return set()
        return touched


def observe(function: Callable, operation: Operation, case: Case) -> Observation:
    """What an implementation does in one case: in float64 and float32, again, and with views."""
    seen: Observation = {}
    arguments, another = operation.arguments(case), Case(case.sizes, case.seed + 1)
    try:
        with np.errstate(all="ignore"):
            given = copies(arguments)
            value, pullback = function(*given)
            seen["value"] = np.copy(value)
            seen["altered by the call"] = np.concatenate([np.ravel(a) for a in given])
            dy = drawn_upstream(case, value)
            _pull(seen, "", operation, pullback, upstream := copied(dy))
            both = [np.ravel(a) for a in (*given, upstream)]
            seen["altered by the pullback"] = np.concatenate(both)
            function(*copies(operation.arguments(another)))
            _pull(seen, "again, ", operation, pullback, copied(dy))
            if not np.ndim(value):
                _pull(seen, "by default, ", operation, pullback)
            layout = list(LAYOUTS.values())[1 + case.seed % (len(LAYOUTS) - 1)]
            views = [layout(a) if np.ndim(a) else a for a in arguments.values()]
            value, pullback = function(*views)
            seen["of views, value"] = np.copy(value)
            _pull(seen, "of views, ", operation, pullback, copied(dy))
            value, pullback = function(*map(in_float32, copies(arguments)))
            seen["float32 value"] = np.copy(value)
            dy = in_float32(copied(dy)) if np.ndim(dy) else float(dy)
            _pull(seen, "float32 ", operation, pullback, dy)
    except (Exception, SystemExit) as error:
        seen["raised"] = np.array(type(error).__name__)
    return seen


def _pull(seen: Observation, how: str, operation: Operation, pullback: Callable, *dy) -> None:
    for name, gradient in differentiated(operation, pullback(*dy)).items():
        seen[f"{how}gradient for {name}"] = np.copy(gradient)


def _differing(one: Observation, other: Observation, starts: tuple[str, ...] = ("",)) -> set[str]:
    """The keys of what differs between two observations."""
    keys = {key for key in one.keys() | other.keys() if key.startswith(starts)}
    return {key for key in keys if not _equal(one.get(key), other.get(key))}


def _equal(one: np.ndarray | None, other: np.ndarray | None) -> bool:
    if one is None or other is None or one.shape != other.shape or one.dtype != other.dtype:
        return False
    if one.dtype.kind not in "fc":
        return np.array_equal(one, other)
    close = 1e-4 if one.dtype == np.float32 else 1e-9
    finite = np.abs(one[np.isfinite(one)])
    scale = close * float(np.max(finite, initial=0.0))
    return np.allclose(one, other, rtol=close, atol=scale * 0.01 + 1e-14, equal_nan=True)
