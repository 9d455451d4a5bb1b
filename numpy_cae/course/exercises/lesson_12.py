"""The exercises of lesson 12, trust nobody's gradients: the student's own tests, tested.

A test is right when it lets every right implementation pass and no wrong one; the wrong ones are
the planted bugs.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from numpy_cae import ops, verify
from numpy_cae.course.exercises.exercise import Claim, Exercise, exercise
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.catalogue import properties_of
from numpy_cae.verify.operation import OPERATIONS
from numpy_cae.verify.planted_bugs import PlantedBug, bug_named, bugs_of, right_operation
from numpy_cae.verify.property import require_equal

SUSPECTS: tuple[PlantedBug, ...] = tuple(
    bug_named(name)
    for name in (
        "conv_without_flip",
        "arctanh_gradient_beyond_bound",
        "conv_bias_not_over_windows",
        "step_biases_alike",
        "gru_first_state_dropped",
        "conv_accumulates",
    )
)
"""The bugs to be found by reading, the first one being suspect 1."""

GROUPS = {
    "activations": ("tanh", "sigmoid", "arctanh"),
    "convolution": ("conv1d", "transpose_filters"),
    "pooling": ("max_pool", "unpool_even", "unpool_random"),
    "losses": ("mean_squared_error", "mean_absolute"),
    "recurrence": ("linear", "gru_step", "gru"),
    "tied weights": ("tied_layer",),
}
TRIED_SIZES = {
    "batch": 2, "frames": 3, "channels": 2, "filters": 2, "taps": 3, "features": 2, "axes": 2,
    "hidden": 2,
}  # fmt: skip
"""As many channels as filters, so that a forgotten transpose has to be noticed by its numbers."""
TINY = 1e-6
FEW = 5
"""Draws are enough where each is tried on every bug: with its differences that is many calls."""


@dataclass(frozen=True)
class Cubic:
    """L(x) = Σ w x³, of which central differences with step h make 3 w x² + w h², exactly."""

    w: np.ndarray

    def __call__(self, x: np.ndarray) -> float:
        return float(np.sum(self.w * x**3))

    def __repr__(self) -> str:
        return f"lambda x: np.sum(np.array({np.round(self.w, 4).tolist()}) * x**3)"


@dataclass(frozen=True)
class Matrix:
    """A x with a pullback that is that of another matrix, A itself where it is right."""

    a: np.ndarray
    of_pullback: np.ndarray = field(repr=False)

    def __call__(self, x: np.ndarray) -> tuple[np.ndarray, Callable]:
        return self.a @ x, lambda dy: self.of_pullback.T @ dy


def central_differences(f, x, h):
    """(f(x + h) - f(x - h)) / 2h in one entry after the other."""
    slopes = np.empty(x.shape)
    for index in np.ndindex(x.shape):
        step = np.zeros(x.shape)
        step[index] = h
        slopes[index] = (f(x + step) - f(x - step)) / (2 * h)
    return slopes


def adjoint_gap(f, x, y):
    """|<A x, y> - <x, A' y>|, relative to the sizes of what is multiplied."""
    value, pullback = f(x)
    pulled = pullback(y)
    size = np.linalg.norm(value) * np.linalg.norm(y) + np.linalg.norm(x) * np.linalg.norm(pulled)
    return abs(np.sum(value * y) - np.sum(x * pulled)) / size


def accuse(suspect):
    """The property that suspect 1, 2, ... lacks."""
    return SUSPECTS[suspect - 1].caught_by


def check_gradients(f, inputs):
    """Raise unless the pullback of f agrees with differences in every input."""
    verify.check_gradients(f, *inputs.values(), names=tuple(inputs))


def _differences(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["rows"], case["columns"])
    return {"f": Cubic(spread(rng, shape)), "x": spread(rng, shape), "h": 0.25}


def _slopes(function, case: Case) -> None:
    f, x, h = _differences(case).values()
    require_equal("the slope", function(f, x.copy(), h), 3 * f.w * x**2 + f.w * h**2)


def _x_restored(function, case: Case) -> None:
    f, x, h = _differences(case).values()
    given = x.copy()
    function(f, given, h)
    require_equal("afterwards, x", given, x)


def _right_matrix(case: Case) -> dict[str, object]:
    rng = case.rng()
    a = spread(rng, (case["rows"], case["columns"]))
    x, y = spread(rng, a.shape[1:]), spread(rng, a.shape[:1])
    return {"f": Matrix(a, a), "x": x, "y": y}


def _wrong_matrix(case: Case) -> dict[str, object]:
    f, x, y = _right_matrix(case).values()
    return {"f": Matrix(f.a, f.a[::-1] + 1), "x": x, "y": y}


def _no_gap(function, case: Case) -> None:
    found = function(*_right_matrix(case).values())
    require_equal("of a right pullback, the gap", found, 0.0, 1e-12)


def _gap(function, case: Case) -> None:
    arguments = _wrong_matrix(case).values()
    require_equal("of a wrong pullback, the gap", function(*arguments), adjoint_gap(*arguments))


def _accused(number: int) -> Claim:
    suspect = SUSPECTS[number - 1]

    def check(function, case: Case) -> None:
        named = function(number)
        stated = {tried.name: tried for tried in properties_of(suspect.operation)}
        if named not in stated:
            raise AssertionError(
                f"{suspect.operation} has no property {named!r}; it has {', '.join(stated)}"
            )
        for seed in range(20):
            sizes = tuple((n, max(options)) for n, options in stated[named].sizes.items())
            try:
                stated[named].check(suspect.function(), Case(sizes, seed))
            except Exception:
                return
        raise AssertionError(f"suspect {number} keeps {named!r}: it is not guilty of that")

    return Claim(f"suspect {number}", f"the {suspect.operation} lacks the property you name", check)


def _case(case: Case) -> dict[str, object]:
    return {"seed": case.seed}


def _tried(operation: str, implementation: Callable, seed: int, size: float = 1.0):
    """f and its inputs by name, the undifferentiated arguments closed over."""
    known = OPERATIONS[operation]
    sizes = tuple((name, TRIED_SIZES[name]) for name in known.sizes)
    arguments = known.arguments(Case(sizes, seed))
    inputs = {name: size * arguments[name] for name in known.differentiated}

    def f(*given):
        named = dict(zip(inputs, given, strict=True))
        others = {k: v * size if k == "x" else v for k, v in arguments.items() if k not in named}
        return implementation(*({**arguments, **others, **named}.values()))

    return f, inputs


def _right(operation: str) -> Callable:
    return right_operation(operation)


def _passes_right_ones(check_gradients, case: Case) -> None:
    for operation in (name for group in GROUPS.values() for name in group):
        f, inputs = _tried(operation, _right(operation), case.seed)
        try:
            check_gradients(f, inputs)
        except AssertionError as error:
            raise AssertionError(f"it refuses {operation}, which is right: {error}") from None


def _refuses(group: str) -> Callable:
    def check(check_gradients, case: Case) -> None:
        for bug in _bugs_in_gradients(GROUPS[group]):
            f, inputs = _tried(bug.operation, bug.function(), case.seed)
            _require_refusal(check_gradients, bug, f, inputs)

    return check


def _bugs_in_gradients(operations: tuple[str, ...]) -> Iterator[PlantedBug]:
    for operation in operations:
        for bug in bugs_of(operation):
            if bug.caught_by.startswith("gradient for"):
                yield bug


def _require_refusal(check_gradients, bug: PlantedBug, f, inputs) -> None:
    try:
        check_gradients(f, inputs)
    except AssertionError:
        return
    raise AssertionError(f"it lets a wrong {bug.operation} pass: {bug.sentence}")


def _refuses_tiny(check_gradients, case: Case) -> None:
    bug = bug_named("squared_without_two")
    f, inputs = _tried(bug.operation, bug.function(), case.seed, TINY)
    _require_refusal(check_gradients, bug, f, inputs)


def _names_the_culprit(check_gradients, case: Case) -> None:
    for name in ("conv_without_flip", "conv_filters_reversed", "conv_bias_averaged"):
        bug = bug_named(name)
        culprit = bug.caught_by.rpartition(" ")[2]
        message = ""
        try:
            check_gradients(*_tried(bug.operation, bug.function(), case.seed))
        except AssertionError as error:
            message = str(error)
        if culprit not in re.findall(r"\w+", message):
            raise AssertionError(
                f"the gradient for {culprit} is wrong, but the message is {message!r}"
            )


def _inputs_stay(check_gradients, case: Case) -> None:
    f, inputs = _tried("conv1d", ops.conv1d, case.seed)
    before = {name: x.copy() for name, x in inputs.items()}
    check_gradients(f, inputs)
    for name, x in before.items():
        require_equal(f"afterwards, {name}", inputs[name], x, 0)


ONE = {"tried": (1,)}

EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "central_differences",
        "one entry at a time, a little up and a little down; np.ndindex walks over the entries",
        central_differences,
        _differences,
        {"rows": (1, 2), "columns": (1, 2, 3)},
        (
            Claim(
                "value",
                "of a cubic, exactly the central difference: step h to both sides, over 2h",
                _slopes,
                2,
                "each slope is that of one entry: every other entry of x stays where it is",
            ),
            Claim("x restored", "x is afterwards what it was", _x_restored),
        ),
    ),
    exercise(
        "adjoint_gap",
        "two inner products, one with what f makes of x, one with what the pullback makes of y",
        adjoint_gap,
        _wrong_matrix,
        {"rows": (1, 2, 3), "columns": (1, 2, 3)},
        (
            Claim("right ones", "for a matrix and its transpose it is 0 to rounding", _no_gap),
            Claim("wrong ones", "for another matrix's transpose it is what is defined", _gap),
        ),
    ),
    exercise(
        "accuse",
        "check the lines one by one against the equations in the docstring of the right one",
        accuse,
        _case,
        ONE,
        [_accused(number) for number in range(1, len(SUSPECTS) + 1)],
    ),
    exercise(
        "check_gradients",
        "draw an upstream gradient; the loss is Σ dy ∘ f; compare the pullback's gradient for each "
        "input with differences of that loss, relative to the size of the gradient",
        check_gradients,
        _case,
        ONE,
        (
            Claim(
                "right ones pass",
                "no right operation is refused",
                _passes_right_ones,
                2,
                "rounding is proportional to the numbers: is your tolerance relative?",
                examples=FEW,
            ),
            *(
                Claim(
                    f"{group}",
                    f"every wrong {' or '.join(operations)} among the planted bugs is refused",
                    _refuses(group),
                    2,
                    "is your upstream gradient drawn, and is every input tried?",
                    examples=FEW,
                )
                for group, operations in GROUPS.items()
            ),
            Claim(
                "tiny numbers",
                "a wrong gradient is refused even where all numbers are near 1e-6",
                _refuses_tiny,
                1,
                "an absolute tolerance is larger than everything here",
            ),
            Claim(
                "names the culprit",
                "the message has the name of the input whose gradient is wrong, as a word",
                _names_the_culprit,
            ),
            Claim("inputs stay", "the inputs are afterwards what they were", _inputs_stay),
        ),
    ),
)
