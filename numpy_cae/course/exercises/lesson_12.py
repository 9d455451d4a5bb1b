"""The checks and arguments of lesson 12: tests of the student's own checks of gradients.

A check is right if every right implementation passes and no wrong one does. The wrong ones are
the planted bugs of `verify`.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.checks import Recorded, checks
from numpy_cae.course.solutions.lesson_12 import adjoint_gap
from numpy_cae.course.suspects import SUSPECTS
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.patch import BUGS, Patch, bug_named, right_operation
from numpy_cae.verify.operations.property import Property, require_equal

GROUPS = {
    "activations": ("tanh", "sigmoid", "arctanh"),
    "convolution": ("conv1d", "transpose_filters"),
    "pooling": ("max_pool", "unpool_even", "unpool_random"),
    "losses": ("mean_squared_error", "mean_absolute"),
    "recurrence": ("linear", "gru_step", "gru"),
    "tied weights": ("tied_layer",),
}
SIZES = {"batch": 2, "frames": 4, "taps": 3, "axes": 2} | dict.fromkeys(
    ("channels", "filters", "features", "hidden"), 2
)
"""As many channels as filters, so that a missing transpose shows only in the numbers."""
TINY = 1e-6
WITH_WRONG_GRADIENT = tuple(bug for bug in BUGS if bug.caught_by.startswith("gradient for"))
Checked = tuple[Callable, dict[str, np.ndarray]]
"""A function and its inputs by name: the arguments of `check_gradients`."""


@dataclass(frozen=True)
class Matrix:
    """A x with the pullback of another matrix, or of A itself if it is right."""

    a: np.ndarray
    of_pullback: np.ndarray = field(repr=False)

    def __call__(self, x: np.ndarray) -> tuple[np.ndarray, Callable]:
        return self.a @ x, lambda dy: self.of_pullback.T @ dy


def cubic(case: Case, rng: np.random.Generator, made: dict) -> Recorded:
    """L(x) = Σ w x³; its central difference with step h is exactly 3 w x² + w h²."""
    w = spread(rng, (case["rows"], case["columns"]))
    return Recorded(f"lambda x: np.sum(np.array({np.round(w, 4).tolist()}) * x**3)")


def matrix_arguments(case: Case) -> dict[str, object]:
    """A matrix with a wrong pullback, and arrays of two axes for which the gap is not 0."""
    rng = case.rng()
    a = spread(rng, (case["rows"], case["columns"]))
    x = spread(rng, (case["columns"], 2)) + 3.0
    y = spread(rng, (case["rows"], 2)) + 3.0
    return {"f": Matrix(a, a + 1), "x": x, "y": y}


def seed(case: Case, rng: np.random.Generator, made: dict) -> int:
    """The seed of the case, from which a check draws everything."""
    return case.seed


@checks("adjoint_gap", "right ones")
def _no_gap(function, case, f, x, y):
    gap = function(Matrix(f.a, f.a), x, y)
    require_equal("for a right pullback, the gap", gap, 0.0, 1e-12)


@checks("adjoint_gap", "wrong ones")
def _right_gap(function, case, f, x, y):
    gap = function(f, x, y)
    require_equal("for f, whose pullback is another matrix's, the gap", gap, adjoint_gap(f, x, y))


def _accused(number: int, function, case, seed) -> None:
    if objection := SUSPECTS[number - 1].objection(function(number)):
        raise AssertionError(objection)


for number in range(1, len(SUSPECTS) + 1):
    checks("accuse", f"suspect {number}")(partial(_accused, number))


def _checked(operation: str, implementation: Callable, seed: int, scale: float = 1.0) -> Checked:
    """f and its inputs; f closes over the arguments that get no gradient."""
    stated = OPERATIONS[operation]
    sizes = tuple((name, SIZES[name]) for name in stated.sizes if name in SIZES)
    arguments = stated.arguments(Case(sizes, seed))
    inputs = {name: scale * arguments[name] for name in stated.differentiated}
    if "x" in arguments:
        arguments["x"] = scale * arguments["x"]
    if "first" in arguments:  # a mask of one value would hide what is wrong at the other
        arguments["first"].flat[:2] = True, False

    def f(*values):
        return implementation(*(arguments | dict(zip(inputs, values, strict=True))).values())

    return f, inputs


def _right(operation: str, seed: int) -> Checked:
    return _checked(operation, right_operation(operation), seed)


def _wrong(bug: Patch, seed: int, scale: float = 1.0) -> Checked:
    return _checked(bug.operation, bug.function(), seed, scale)


def _require_acceptance(check_gradients, operations: tuple[str, ...], seed: int) -> None:
    for operation in operations:
        try:
            check_gradients(*_right(operation, seed))
        except AssertionError as error:
            raise AssertionError(f"it refuses {operation}, which is right: {error}") from None


def _require_refusal(check_gradients, bug: Patch, seed: int, scale: float = 1.0) -> str:
    """The message with which a wrong operation is refused."""
    try:
        check_gradients(*_wrong(bug, seed, scale))
    except AssertionError as error:
        return str(error)
    raise AssertionError(f"it accepts a wrong {bug.operation}: {bug.sentence}")


@checks("check_gradients", "right ones pass")
def _right_ones_pass(check_gradients, case, seed):
    _require_acceptance(check_gradients, sum(GROUPS.values(), ()), seed)


def _tells_apart(operations: tuple[str, ...], check_gradients, case, seed) -> None:
    _require_acceptance(check_gradients, operations, seed)
    for bug in WITH_WRONG_GRADIENT:
        if bug.operation in operations:
            _require_refusal(check_gradients, bug, seed)


for name, operations in GROUPS.items():
    checks("check_gradients", name)(partial(_tells_apart, operations))


@checks("check_gradients", "tiny numbers")
def _refuses_tiny(check_gradients, case, seed):
    _require_acceptance(check_gradients, GROUPS["losses"], seed)
    _require_refusal(check_gradients, bug_named("squared_without_two"), seed, TINY)


@checks("check_gradients", "names the culprit")
def _names_the_input(check_gradients, case, seed):
    for name in ("conv_without_flip", "conv_filters_reversed", "conv_bias_averaged"):
        bug = bug_named(name)
        wrong = bug.caught_by.rpartition(" ")[2]
        message = _require_refusal(check_gradients, bug, seed)
        if wrong not in re.findall(r"\w+", message):
            raise AssertionError(f"the gradient for {wrong} is wrong; the message is {message!r}")


@checks("check_gradients", "inputs stay", copied=False)
def _inputs_stay(check_gradients, case, seed):
    f, inputs = _checked("conv1d", ops.conv1d, seed)
    before = {name: x.copy() for name, x in inputs.items()}
    check_gradients(f, inputs)
    for name, x in before.items():
        require_equal(f"after the call, {name}", inputs[name], x, 0)


AT = np.array([0.5 + 5e-9, 1.0 + 5e-9])
"""Where the traps are tried: in the middle of a stair of 1e-8, on the corners of `corner`."""
TRAPS = {
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


def _trap(value: Callable, gradient: Callable, seed: int) -> Checked:
    return lambda x: (value(x), lambda dy: gradient(x, dy)), {"x": AT.copy()}


QUICK = (*GROUPS["activations"], *GROUPS["losses"], *GROUPS["tied weights"])
PLANTED = [bug for bug in WITH_WRONG_GRADIENT if bug.operation in QUICK]
TRIED = {name: partial(_trap, *each) for name, each in TRAPS.items()}
TRIED |= {name: partial(_right, name) for name in QUICK}
TRIED |= {bug.name: partial(_wrong, bug) for bug in PLANTED}
TRIED |= {
    f"tiny {bug.name}": partial(_wrong, bug, scale=TINY)
    for bug in PLANTED
    if "squared" in bug.operation
}
VERDICTS = Property(
    "verdicts",
    "what is refused",
    lambda *given: None,
    sizes={"function": tuple(TRIED)},
    operation="check_gradients",
    arguments=lambda case: dict(
        zip(("f", "inputs"), TRIED[case["function"]](case.seed), strict=True)
    ),
    combined=("function",),
)
"""All that `check_gradients` is tried with: what it refuses shows its mistake."""
