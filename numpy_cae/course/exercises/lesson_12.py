"""The exercises of lesson 12, trust nobody's gradients: tests of the student's own checks.

A check is right if every right implementation passes and no wrong one does. The wrong ones are
the planted bugs of `verify`.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from numpy_cae import ops, verify
from numpy_cae.course.exercises.checks import Recorded, drawn, states
from numpy_cae.course.exercises.exercise import exercise, right_function
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.catalogue import properties_of_operation
from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.patch import BUGS, Patch, bug_named, right_operation
from numpy_cae.verify.operations.property import Property, require_equal
from numpy_cae.verify.operations.trial import failing_case

CATCH_ALL = "special inputs"
"""CATCH_ALL: a property of every operation that nearly every bug violates; naming it says nothing
about the mistake."""


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
        has_it = failing_case(stated[named], self._bug.function()) is None
        return f"this {self.operation} has the property {named!r}" if has_it else ""

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
SIZES = {"batch": 2, "frames": 3, "taps": 3, "axes": 2} | dict.fromkeys(
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


central_differences, adjoint_gap = map(right_function, ("central_differences", "adjoint_gap"))
"""(f(x + h) - f(x - h)) / 2h, and |<A x, y> - <x, A' y>| relative to the norms of the factors."""


def accuse(suspect):
    """The property that suspect 1, 2, ... violates."""
    return _ACCUSED[suspect - 1].caught_by


def check_gradients(f, inputs):
    """Raise unless the pullback of f agrees with differences in every input."""
    verify.check_gradients(f, *inputs.values(), names=tuple(inputs))


def _cubic(case: Case, rng: np.random.Generator) -> Recorded:
    """L(x) = Σ w x³; its central difference with step h is exactly 3 w x² + w h²."""
    w = spread(rng, (case["rows"], case["columns"]))
    text = f"lambda x: np.sum(np.array({np.round(w, 4).tolist()}) * x**3)"
    return Recorded(text, lambda x: float(np.sum(w * x**3)))


def _wrong_matrix_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    a = spread(rng, (case["rows"], case["columns"]))
    x, y = spread(rng, a.shape[1:]), spread(rng, a.shape[:1])
    return {"f": Matrix(a, a[::-1] + 1), "x": x, "y": y}


_seed_arguments = drawn(seed=lambda case, rng: case.seed)


@states("right ones", "for a matrix and its transpose it is 0 to rounding", is_form=True)
def _no_gap(function, case, f, x, y):
    gap = function(Matrix(f.a, f.a), x, y)
    require_equal("for a right pullback, the gap", gap, 0.0, 1e-12)


@states("wrong ones", "for another matrix's transpose it is as defined")
def _right_gap(function, case, f, x, y):
    require_equal("for a wrong pullback, the gap", function(f, x, y), adjoint_gap(f, x, y))


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
        for bug in BUGS:
            if bug.operation in GROUPS[group] and bug.caught_by.startswith("gradient for"):
                _require_refusal(check_gradients, bug, seed)

    operations = " or ".join(GROUPS[group])
    statement = f"every planted bug of {operations} is refused, right ones are not"
    return states(group, statement, examples=FEW_EXAMPLES)(check)


def _require_refusal(check_gradients, bug: Patch, seed: int, scale: float = 1.0) -> None:
    f, inputs = _function_and_inputs(bug.operation, bug.function(), seed, scale)
    try:
        check_gradients(f, inputs)
    except AssertionError:
        return
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
        message = ""
        try:
            check_gradients(*_function_and_inputs(bug.operation, bug.function(), seed))
        except AssertionError as error:
            message = str(error)
        if wrong not in re.findall(r"\w+", message):
            raise AssertionError(f"the gradient for {wrong} is wrong; the message is {message!r}")


@states("inputs stay", "the inputs are not changed", copied=False, is_form=True)
def _inputs_stay(check_gradients, case, seed):
    f, inputs = _function_and_inputs("conv1d", ops.conv1d, seed)
    before = {name: x.copy() for name, x in inputs.items()}
    check_gradients(f, inputs)
    for name, x in before.items():
        require_equal(f"after the call, {name}", inputs[name], x, 0)


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
