"""What a student's check of gradients, an exercise of lesson 12, is tried with.

A check is right if every right implementation passes and no wrong one does. The wrong ones are
the planted bugs of `verify`.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.patch import BUGS, Patch
from numpy_cae.verify.operations.property import Property

GROUPS = {
    "activations": ("tanh", "sigmoid", "arctanh"),
    "convolution": ("conv1d", "transpose_filters"),
    "pooling": ("max_pool", "unpool_even", "unpool_random"),
    "losses": ("mean_squared_error", "mean_absolute"),
    "recurrence": ("linear", "gru_step", "gru"),
    "tied weights": ("tied_layer",),
}
LONGER = {"frames": 4, "taps": 3}
"""All other sizes are 2. With as many channels as filters a missing transpose shows only in
the numbers."""
TINY = 1e-6


@dataclass(frozen=True)
class Trial:
    """An operation, right or with a planted bug, whose inputs are multiplied by a scale."""

    operation: str
    bug: Patch | None = None
    scale: float = 1.0

    def arguments(self, seed: int) -> dict[str, Any]:
        """The arguments of `check_gradients`: f, and its inputs by name.

        f closes over the arguments that get no gradient.
        """
        operation = OPERATIONS[self.operation]
        implementation = self.bug.function() if self.bug else operation.reference
        numbers = [name for name, options in operation.sizes.items() if isinstance(options[0], int)]
        sizes = tuple((name, LONGER.get(name, 2)) for name in numbers)
        arguments: dict[str, Any] = operation.arguments(Case(sizes, seed))
        inputs = {name: self.scale * arguments[name] for name in operation.differentiated}
        if "x" in arguments:
            arguments["x"] = self.scale * arguments["x"]
        if "first" in arguments:  # a mask of one value would hide what is wrong at the other
            arguments["first"].flat[:2] = True, False

        def f(*values):
            return implementation(*(arguments | dict(zip(inputs, values, strict=True))).values())

        return {"f": f, "inputs": inputs}

    def verdict(self, check_gradients: Callable, seed: int) -> str:
        """The message with which a wrong operation is refused; an error if the check is wrong."""
        try:
            check_gradients(*self.arguments(seed).values())
        except AssertionError as error:
            if self.bug:
                return str(error)
            raise AssertionError(f"it refuses {self.operation}, which is right: {error}") from None
        if self.bug:
            raise AssertionError(f"it accepts a wrong {self.operation}: {self.bug.sentence}")
        return ""


RIGHT = [Trial(operation) for names in GROUPS.values() for operation in names]
WRONG = {b.name: Trial(b.operation, b) for b in BUGS if b.caught_by.startswith("gradient for")}
"""The operations with a wrong gradient, by the name of the bug."""


def trials_of(operations: Collection[str]) -> list[Trial]:
    """The trials of some operations, the right ones first."""
    return [trial for trial in (*RIGHT, *WRONG.values()) if trial.operation in operations]


REQUIRED = {name: trials_of(operations) for name, operations in GROUPS.items()}
REQUIRED["right ones pass"] = RIGHT
REQUIRED["tiny numbers"] = [*map(Trial, GROUPS["losses"])]
REQUIRED["tiny numbers"] += [replace(WRONG["squared_without_two"], scale=TINY)]
"""The trials of each property of `check_gradients`."""
NAMED = [WRONG[bug] for bug in ("conv_without_flip", "conv_filters_reversed", "conv_bias_averaged")]
"""Trials in which the message has to name the input whose gradient is wrong."""
AT = np.array([0.5 + 5e-9, 1.0 + 5e-9])
"""Where the traps are tried: in the middle of a stair of 1e-8, on the corners of `corner`."""
TRAPS: dict[str, tuple[Callable, Callable]] = {
    "dy ignored": (np.square, lambda x, dy: 2 * x),
    "twice": (np.square, lambda x, dy: 4 * x * dy),
    "negative": (np.square, lambda x, dy: -2 * x * dy),
    "in other entries": (np.square, lambda x, dy: (2 * x * dy)[::-1]),
    "too small": (np.square, lambda x, dy: 2 * x * dy - 1),
    "far too small": (np.square, lambda x, dy: 2 * x * dy - 9),
    "too large": (np.square, lambda x, dy: 2 * x * dy + 1),
    "one sum": (np.square, lambda x, dy: np.full(2, np.sum(2 * x * dy))),
    "of the right": (lambda x: np.maximum(x - AT, 0), lambda x, dy: dy),
    "of the left": (lambda x: np.maximum(x - AT, 0), lambda x, dy: 0 * dy),
    "of a stair": (lambda x: np.floor(1e8 * x) / 1e8, lambda x, dy: 0 * dy),
    "of a plateau": (lambda x: np.trunc(200 * (x - AT)), lambda x, dy: 0 * dy),
    "constant": (lambda x: 0 * x, lambda x, dy: 0 * dy),
}
"""Functions of an array with a gradient that a check with a certain mistake takes for right."""


def _trap(value: Callable, gradient: Callable, seed: int) -> dict[str, Any]:
    return {"f": lambda x: (value(x), partial(gradient, x)), "inputs": {"x": AT.copy()}}


QUICK = trials_of((*GROUPS["activations"], *GROUPS["losses"], *GROUPS["tied weights"]))
QUICK += [replace(trial, scale=TINY) for trial in WRONG.values() if "squared" in trial.operation]
DRAW: dict[str, Callable[[int], dict[str, Any]]] = {
    name: partial(_trap, value, gradient) for name, (value, gradient) in TRAPS.items()
}
DRAW |= {f"{number}": trial.arguments for number, trial in enumerate(QUICK)}
"""What draws the arguments of `check_gradients` by a seed, by the name of what is tried."""


def _holds_always(function: Callable, case: Case) -> None:
    """No check: what is refused is compared with what a known mistake refuses."""


def _verdict_arguments(case: Case) -> dict[str, Any]:
    return DRAW[str(case["function"])](case.seed)


VERDICTS = Property(
    "verdicts",
    "what is refused",
    _holds_always,
    sizes={"function": tuple(DRAW)},
    operation="check_gradients",
    arguments=_verdict_arguments,
    combined=("function",),
)
"""All that `check_gradients` is tried with: what it refuses shows its mistake."""
