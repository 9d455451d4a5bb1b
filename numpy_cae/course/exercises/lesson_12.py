"""The exercises of lesson 12, trust nobody's gradients: tests of the student's own checks.

A check is right if every right implementation passes and no wrong one does. The wrong ones are
the planted bugs of `verify`.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.checks import Recorded, drawn, states
from numpy_cae.course.exercises.exercise import exercise
from numpy_cae.course.solutions.lesson_12 import (
    adjoint_gap,
    central_differences,
    check_gradients,
)
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.catalogue import properties_of_operation
from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.patch import BUGS, Patch, bug_named, right_operation
from numpy_cae.verify.operations.property import Property, require_equal
from numpy_cae.verify.operations.trial import failing_case

CATCH_ALL = "special inputs"
"""CATCH_ALL: a property of every operation that nearly every bug violates; naming it says nothing
about the mistake."""


MEANT = {"purity": ("purity", "independence")}
"""MEANT: a function that keeps something between two calls is not pure either, as programmers use
the word."""


class Suspect:
    """A wrong operation whose mistake is to be found by reading."""

    def __init__(self, bug: Patch) -> None:
        self._bug = bug
        self.operation = bug.operation

    def source(self) -> str:
        """The source of the wrong operation."""
        return self._bug.source()

    def objection(self, named: object) -> str:
        """Why the name of a property is no answer; "" if the operation violates that property."""
        stated = {prop.name: prop for prop in properties_of_operation(self.operation)}
        if named == CATCH_ALL:
            return f"{CATCH_ALL!r} tests every result: name the property that the mistake is about"
        if named not in stated:
            names = ", ".join(name for name in stated if name != CATCH_ALL)
            return f"{self.operation} has no property {named!r}; it has {names}"
        meant = [stated[each] for each in MEANT.get(named, (named,))]
        if any(failing_case(one, self._bug.function()) is not None for one in meant):
            return ""
        return f"this {self.operation} has the property {named!r}: {meant[0].statement}"

    def verdict(self, named: object) -> str:
        """The mistake if the answer is right, else what is wrong with the answer."""
        objection = self.objection(named)
        return f"not yet: {objection}" if objection else self._bug.sentence


_ACCUSED = tuple(
    bug_named(name)
    for name in (
        "conv_without_flip arctanh_gradient_beyond_bound conv_bias_not_over_windows "
        "step_biases_alike gru_first_state_dropped conv_accumulates"
    ).split()
)
SUSPECTS = tuple(map(Suspect, _ACCUSED))
"""The bugs to be found by reading, the first one being suspect 1."""

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
FEW_EXAMPLES = 5
"""Each example tries every bug, with all its differences."""


@dataclass(frozen=True)
class Matrix:
    """A x with the pullback of another matrix, or of A itself if it is right."""

    a: np.ndarray
    of_pullback: np.ndarray = field(repr=False)

    def __call__(self, x: np.ndarray) -> tuple[np.ndarray, Callable]:
        return self.a @ x, lambda dy: self.of_pullback.T @ dy


def accuse(suspect):
    """The property that suspect 1, 2, ... violates."""
    return _ACCUSED[suspect - 1].caught_by


def _cubic(case: Case, rng: np.random.Generator) -> Recorded:
    """L(x) = Σ w x³; its central difference with step h is exactly 3 w x² + w h²."""
    w = spread(rng, (case["rows"], case["columns"]))
    text = f"lambda x: np.sum(np.array({np.round(w, 4).tolist()}) * x**3)"
    return Recorded(text, lambda x: float(np.sum(w * x**3)))


def _wrong_matrix_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    a = spread(rng, (case["rows"], case["columns"]))
    x, y = spread(rng, a.shape[1:]) + 3.0, spread(rng, a.shape[:1]) + 3.0  # above 0: no gap is 0
    return {"f": Matrix(a, a + 1), "x": x, "y": y}


_seed_arguments = drawn(seed=lambda case, rng: case.seed)


@states("right ones", "for a matrix and its transpose it is 0 to rounding", is_form=True)
def _no_gap(function, case, f, x, y):
    gap = function(Matrix(f.a, f.a), x, y)
    require_equal("for a right pullback, the gap", gap, 0.0, 1e-12)


@states("wrong ones", "for another matrix's transpose it is as defined")
def _right_gap(function, case, f, x, y):
    gap = function(f, x, y)
    require_equal("for f, whose pullback is another matrix's, the gap", gap, adjoint_gap(f, x, y))


def _accused(number: int) -> Property:
    suspect = SUSPECTS[number - 1]

    def check(function, case, seed):
        if objection := suspect.objection(function(number)):
            raise AssertionError(objection)

    statement = f"the {suspect.operation} violates the property that you name"
    return states(f"suspect {number}", statement, examples=1)(check)


def _function_and_inputs(operation: str, implementation: Callable, seed: int, scale: float = 1.0):
    """f and its inputs by name; f closes over the arguments that get no gradient."""
    stated = OPERATIONS[operation]
    sizes = tuple((name, SIZES[name]) for name in stated.sizes if name in SIZES)
    arguments = stated.arguments(Case(sizes, seed))
    inputs = {name: scale * arguments[name] for name in stated.differentiated}
    if "x" in arguments:
        arguments["x"] = scale * arguments["x"]

    def f(*values):
        return implementation(*(arguments | dict(zip(inputs, values, strict=True))).values())

    return f, inputs


@states("right ones pass", "no right operation is refused", examples=FEW_EXAMPLES)
def _right_ones_pass(check_gradients, case, seed):
    _require_acceptance(check_gradients, sum(GROUPS.values(), ()), seed)


def _require_acceptance(check_gradients, operations: tuple[str, ...], seed: int) -> None:
    for operation in operations:
        try:
            check_gradients(*_function_and_inputs(operation, right_operation(operation), seed))
        except AssertionError as error:
            raise AssertionError(f"it refuses {operation}, which is right: {error}") from None


def _refuses_group(group: str) -> Property:
    def check(check_gradients, case, seed):
        _require_acceptance(check_gradients, GROUPS[group], seed)
        for bug in filter(_has_a_wrong_gradient, BUGS):
            if bug.operation in GROUPS[group]:
                _require_refusal(check_gradients, bug, seed)

    operations = " or ".join(GROUPS[group])
    statement = f"every planted bug of {operations} is refused, right ones are not"
    return states(group, statement, examples=FEW_EXAMPLES)(check)


def _has_a_wrong_gradient(bug: Patch) -> bool:
    return bug.caught_by.startswith("gradient for")


def _require_refusal(check_gradients, bug: Patch, seed: int, scale: float = 1.0) -> str:
    """The message with which a wrong operation is refused."""
    f, inputs = _function_and_inputs(bug.operation, bug.function(), seed, scale)
    try:
        check_gradients(f, inputs)
    except AssertionError as error:
        return str(error)
    raise AssertionError(f"it accepts a wrong {bug.operation}: {bug.sentence}")


@states("tiny numbers", "a wrong gradient is refused even if all numbers are near 1e-6")
def _refuses_tiny(check_gradients, case, seed):
    _require_acceptance(check_gradients, GROUPS["losses"], seed)
    _require_refusal(check_gradients, bug_named("squared_without_two"), seed, TINY)


NAMED = "the message has the name of the input whose gradient is wrong, as a word"


@states("names the culprit", NAMED)
def _names_the_input(check_gradients, case, seed):
    for name in ("conv_without_flip", "conv_filters_reversed", "conv_bias_averaged"):
        bug = bug_named(name)
        wrong = bug.caught_by.rpartition(" ")[2]
        message = _require_refusal(check_gradients, bug, seed)
        if wrong not in re.findall(r"\w+", message):
            raise AssertionError(f"the gradient for {wrong} is wrong; the message is {message!r}")


@states("inputs stay", "the inputs are not changed", copied=False, is_form=True)
def _inputs_stay(check_gradients, case, seed):
    f, inputs = _function_and_inputs("conv1d", ops.conv1d, seed)
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
    "too large": (np.square, lambda x, dy: 2 * x * dy + 1),
    "one sum": (np.square, lambda x, dy: np.full(2, np.sum(2 * x * dy))),
    "of the right": (lambda x: np.maximum(x - AT, 0), lambda x, dy: dy),
    "of the left": (lambda x: np.maximum(x - AT, 0), lambda x, dy: 0 * dy),
    "of a stair": (lambda x: np.floor(1e8 * x) / 1e8, lambda x, dy: 0 * dy),
    "of a plateau": (lambda x: np.trunc(200 * (x - AT)), lambda x, dy: 0 * dy),
    "constant": (lambda x: 0 * x, lambda x, dy: 0 * dy),
}
"""Functions of an array with a gradient that a check with a certain mistake takes for right."""
FAST = tuple(sum((GROUPS[group] for group in ("activations", "losses", "tied weights")), ()))
PLANTED = [bug for bug in BUGS if bug.operation in FAST and _has_a_wrong_gradient(bug)]
OPERATIONS_TRIED = {each: Patch(each, each, "", "", ()) for each in FAST}
OPERATIONS_TRIED |= {bug.name: bug for bug in PLANTED}
OPERATIONS_TRIED |= {f"{TINY} {bug.name}": bug for bug in PLANTED if "squared" in bug.operation}


def _function_tried(case: Case) -> dict[str, object]:
    """A trap, an operation or a planted bug, as the arguments of `check_gradients`."""
    name = case["function"]
    if name in TRAPS:
        value, gradient = TRAPS[name]
        return {"f": lambda x: (value(x), lambda dy: gradient(x, dy)), "inputs": {"x": AT.copy()}}
    tried = OPERATIONS_TRIED[name]
    scale = float(name.partition(" ")[0]) if " " in name else 1.0
    f, inputs = _function_and_inputs(tried.operation, tried.function(), case.seed, scale)
    return {"f": f, "inputs": inputs}


TRIED = {"function": (*TRAPS, *OPERATIONS_TRIED)}
ITS = {"operation": "check_gradients", "arguments": _function_tried, "combined": ("function",)}
VERDICTS = Property("verdicts", "what is refused", lambda *given: None, sizes=TRIED, **ITS)
"""All that `check_gradients` is tried with: what it refuses shows its mistake."""
ONE_CASE = {"tried": (1,)}

EXERCISES = (
    exercise(
        central_differences,
        drawn(f=_cubic, x="rows columns", h=0.25),
        {"rows": (1, 2), "columns": (1, 2, 3)},
        value="for a cubic, exactly the central difference: step h to both sides, over 2h",
    ),
    exercise(
        adjoint_gap,
        _wrong_matrix_arguments,
        {"rows": (1, 2, 3), "columns": (1, 2, 3)},
        _no_gap,
        _right_gap,
        pure=False,
    ),
    exercise(
        accuse,
        _seed_arguments,
        ONE_CASE,
        *[_accused(number) for number in range(1, len(SUSPECTS) + 1)],
        pure=False,
    ),
    exercise(
        check_gradients,
        _seed_arguments,
        ONE_CASE,
        _right_ones_pass,
        *map(_refuses_group, GROUPS),
        _refuses_tiny,
        _names_the_input,
        _inputs_stay,
        pure=False,
        given="decode_layer encode_layer mean_squared_error sgd_step zero_values",
    ),
)
