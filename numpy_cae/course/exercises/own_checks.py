"""The checks that only one exercise has, lesson by lesson."""

import re
from collections.abc import Callable, Iterable
from functools import partial

import numpy as np

from numpy_cae.course.exercises.arguments import Matrix, headings
from numpy_cae.course.exercises.checks import PULLBACK, on_copies, require_parts, require_same
from numpy_cae.course.exercises.gradient_trials import NAMED, REQUIRED, Trial
from numpy_cae.course.solutions.building_blocks import chain_to_root, from_features
from numpy_cae.course.solutions.second_paper import observed_error
from numpy_cae.course.suspects import SUSPECTS
from numpy_cae.verify.operations.compare import agrees, require_equal
from numpy_cae.verify.operations.values import spread

CHECKS: dict[tuple[str, str], Callable] = {}
"""These checks, by the names of the exercise and the property."""


def register_check(exercise: str, name: str, copied: bool = True) -> Callable[[Callable], Callable]:
    """Register the check that is decorated, of a property of an exercise.

    The check is called with the function, the case, and the arguments of the case by name. If
    `copied`, the function gets copies of what the check passes to it.
    """

    def register(check: Callable) -> Callable:
        CHECKS[exercise, name] = on_copies(check) if copied else check
        return check

    return register


@register_check("chain_to_root", "chain")
def _chain_as_array(function, case, parents, joint):
    chain = np.asarray(chain_to_root(parents, joint))
    require_same(function(parents, joint), chain, ("the chain",))


@register_check("forward_kinematics", "rest pose")
def _rest_pose(function, case, parents, rotations, translations):
    positions = function(parents, np.broadcast_to(np.eye(3), rotations.shape), translations)
    for joint in range(case["joints"]):
        expected = translations[:, list(chain_to_root(parents, joint))].sum(axis=1)
        subject = f"without rotations, the position of joint {joint}"
        require_equal(subject, positions[:, joint], expected)


@register_check("heading_angle", "faces")
def _known_directions(function, case, across):
    lines = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
    for line, expected in zip(lines, (0.0, np.pi / 2, np.pi), strict=True):
        angle = np.asarray(function(line[None]))
        if angle.shape != (1,):
            raise AssertionError(f"for one frame it has shape {angle.shape}, expected (1,)")
        error = (angle[0] - expected + np.pi) % (2 * np.pi) - np.pi
        require_equal(f"for across {line.tolist()}, the angle's error", error, 0.0)


@register_check("heading_angle", "turns")
def _changes_of_heading(function, case, across):
    changes = np.diff(np.asarray(function(across)))
    expected = np.diff(headings(case, case.rng(), {}))
    require_equal("the change from frame to frame", changes, expected)


@register_check("from_features", "first frame")
def _first_frame(function, case, **arguments):
    positions = np.asarray(function(*arguments.values()))
    require_equal("a position in the first frame", positions[0], from_features(**arguments)[0])


def _epochs_of_calls(train_layer, arguments: dict) -> tuple[tuple | list, list[list]]:
    """What the function returns, and the calls of the loss in each epoch."""
    returned = require_parts(train_layer(*arguments.values()), ("weights", "losses"))
    epochs = arguments["epochs"]
    calls = [
        [np.array(entry) for entry in (*passed, *result)]
        for *passed, result in arguments["loss"].calls
    ]
    steps = -(-len(arguments["windows"]) // arguments["batch"])
    if len(calls) != steps * epochs:
        expected = f"expected {steps * epochs}, once for each batch"
        raise AssertionError(f"in {epochs} epochs it calls loss {len(calls)} times, {expected}")
    return returned, [calls[steps * n : steps * (n + 1)] for n in range(epochs)]


@register_check("train_layer", "every window")
def _every_window_once(train_layer, case, **arguments):
    _, epochs = _epochs_of_calls(train_layer, arguments)
    orders = [arguments["windows"][:, 0, 0].tolist()]
    for number, calls in enumerate(epochs):
        if any((x == 0).any() for x, *_ in calls):  # no value of a clean window is 0
            raise AssertionError("the x that loss gets is not clean; is it the corrupted one?")
        order = np.concatenate([x[:, 0, 0] for x, *_ in calls])
        require_equal(f"sorted x[:, 0, 0] of epoch {number}", np.sort(order), np.sort(orders[0]))
        if order.tolist() in orders:
            raise AssertionError(f"epoch {number} has the order of windows or of an earlier epoch")
        orders.append(order.tolist())


@register_check("train_layer", "corruption")
def _corrupted_anew(train_layer, case, **arguments):
    _, epochs = _epochs_of_calls(train_layer, arguments)
    lost = {}
    for x, corrupted, *_ in (call for calls in epochs for call in calls):
        require_equal("where corrupted is not 0, it", corrupted, np.where(corrupted == 0, 0, x))
        for window, zeroed in zip(x, corrupted == 0, strict=True):
            if any(np.array_equal(zeroed, before) for before in lost.get(window[0, 0], ())):
                raise AssertionError("a window loses the same values in two epochs")
            lost.setdefault(window[0, 0], []).append(zeroed)
    share = np.mean([*lost.values()])
    if abs(share - arguments["p"]) > 0.15:
        raise AssertionError(f"p is {arguments['p']}, but {share:.0%} of all values are zero")


@register_check("train_layer", "steps")
def _steps_descend(train_layer, case, **arguments):
    (weights, _), epochs = _epochs_of_calls(train_layer, arguments)
    pairs = weights if isinstance(weights, tuple | list) else ()
    if [isinstance(pair, tuple | list) for pair in pairs] != [True] * len(epochs):
        raise AssertionError("weights has to be a list with (w, b) for each epoch")
    w = arguments["w"]
    b = arguments["b"]
    for number, calls in enumerate(epochs):
        for _, _, w_before, b_before, _, dw, db in calls:
            names = (f"w in epoch {number}", f"b in epoch {number}")
            require_same((w_before, b_before), (w, b), names)
            rate = arguments["rate"] * arguments["decay"] ** number
            w = w - rate * dw
            b = b - rate * db
        require_same(weights[number], (w, b), (f"w after epoch {number}", "b"))


@register_check("train_layer", "losses")
def _mean_losses(train_layer, case, **arguments):
    (_, losses), epochs = _epochs_of_calls(train_layer, arguments)
    require_equal("losses", losses, [np.mean([call[4] for call in calls]) for calls in epochs])


@register_check("complete", "known")
def _known_values_stay(function, case, x, known, **further):
    require_same(function(x, known, *further.values())[known], x[known], ("a known value",))


@register_check("complete", "nothing there")
def _unknown_values_ignored(function, case, x, known, **further):
    number = function(x, known, *further.values())
    with_nan = function(np.where(known, x, np.nan), known, *further.values())
    if not agrees(with_nan, number):  # the function's own results: neither need be right
        raise AssertionError("NaN in place of the unknown values of x changes what it returns")


@register_check("hidden_from_visible", "hidden is NaN")
def _unknown_rows_ignored(function, case, visible, hidden, complete, ridge):
    number = function(visible, hidden, complete, ridge)
    with_nan = np.where(complete[:, None], hidden, np.nan)
    if not agrees(function(visible, with_nan, complete, ridge), number):
        raise AssertionError("NaN in place of the unknown rows of hidden changes what it returns")


@register_check("adjoint_gap", "right ones")
def _no_gap(function, case, f, x, y):
    gap = function(Matrix(f.a, f.a), x, y)
    require_equal("for a right pullback, the gap", gap, 0.0, 1e-12)


def _accused(number: int, function, case, seed) -> None:
    if objection := SUSPECTS[number - 1].objection(function(number)):
        raise AssertionError(objection)


for number in range(1, len(SUSPECTS) + 1):
    register_check("accuse", f"suspect {number}")(partial(_accused, number))


def _tells_apart(trials: list[Trial], check_gradients, case, seed) -> None:
    for trial in trials:
        trial.verdict(check_gradients, seed)


for name, trials in REQUIRED.items():
    register_check("check_gradients", name)(partial(_tells_apart, trials))


@register_check("check_gradients", "names the culprit")
def _names_the_input(check_gradients, case, seed):
    for trial in NAMED:
        wrong = trial.bug.caught_by.rpartition(" ")[2]
        message = trial.verdict(check_gradients, seed)
        if wrong not in re.findall(r"\w+", message):
            raise AssertionError(f"the gradient for {wrong} is wrong; the message is {message!r}")


@register_check("check_gradients", "inputs stay", copied=False)
def _inputs_stay(check_gradients, case, seed):
    f, inputs = Trial("conv1d").arguments(seed).values()
    before = {name: x.copy() for name, x in inputs.items()}
    check_gradients(f, inputs)
    for name, x in before.items():
        require_equal(f"after the call, {name}", inputs[name], x, 0)


@register_check("three_products", "three")
def _three_calls(function, case, alpha, beta, p, q, multiply):
    function(alpha, beta, p, q, multiply)
    if len(multiply.calls) != 3:
        raise AssertionError(f"multiply is called {len(multiply.calls)} times, expected 3")


def _checked_matrices(function, taps: int, frames: int, **frequency: int) -> list[np.ndarray]:
    """A, G and C, with the shapes that they should have."""
    returned = require_parts(function(*frequency.values(), taps, frames), ("A", "G", "C"))
    matrices = [np.asarray(matrix) for matrix in returned]
    products = len(matrices[0]) if matrices[0].ndim else 0
    shapes = ((products, frames + taps - 1), (products, taps), (frames, products))
    for name, matrix, shape in zip("AGC", matrices, shapes, strict=True):
        if matrix.shape != shape:
            raise AssertionError(f"{name} has shape {matrix.shape}, expected {shape}")
    return matrices


def _products(points: int, frequencies: Iterable[int]) -> int:
    """Three products for a complex frequency and one for a real one."""
    return sum(1 if 2 * f in (0, points) else 3 for f in frequencies)


@register_check("block_matrices", "value")
@register_check("one_frequency", "value")
def _part_of_the_sum(function, case, **arguments):
    """Raise unless C ((A x) ∘ (G w)) is what one or all frequencies add to the sum over taps."""
    a, g, c = _checked_matrices(function, **arguments)
    points = a.shape[1]
    rng = case.rng()
    x = spread(rng, (points,))
    w = spread(rng, (case["taps"],))
    spectrum = np.fft.rfft(x) * np.conj(np.fft.rfft(w, points))
    if "frequency" in arguments:
        spectrum[np.arange(len(spectrum)) != arguments["frequency"]] = 0
    expected = np.fft.irfft(spectrum, points)[: case["frames"]]
    require_equal("C @ ((A @ x) * (G @ w))", c @ ((a @ x) * (g @ w)), expected)


@register_check("block_matrices", "few products")
def _few_products(function, case, taps, frames):
    products = len(_checked_matrices(function, taps, frames)[0])
    points = frames + taps - 1
    allowed = _products(points, range(points // 2 + 1))
    if products > allowed:
        raise AssertionError(
            f"{products} products for N = {points} points; three for a complex frequency and one "
            f"for a real one are {allowed}"
        )


@register_check("one_frequency", "few products")
def _one_or_three(function, case, frequency, taps, frames):
    expected = _products(frames + taps - 1, [frequency])
    products = len(_checked_matrices(function, taps, frames, frequency=frequency)[0])
    if products != expected:
        raise AssertionError(f"A has {products} rows, expected {expected}")


@register_check("observed_error", "unknown is NaN")
def _unknown_values(function, case, x_hat, x, known):
    x = np.where(known, x, np.nan)
    loss, pullback = require_parts(function(x_hat, x, known), ("the loss", PULLBACK))
    require_same(loss, observed_error(x_hat, x, known)[0], ("the loss",))
    gradient = pullback()
    if np.shape(gradient) == known.shape:  # another shape is what the gradient's property says
        require_same(gradient * ~known, 0 * known, ("the gradient of an unknown value",))
