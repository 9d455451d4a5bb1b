"""The exercises of lesson 06, learning: equation 3, corruption, a step of descent, the loop."""

import numpy as np

from numpy_cae.course.exercises import lesson_05
from numpy_cae.course.exercises.checks import (
    Recorded,
    drawn,
    require_parts,
    require_same,
    size,
    states,
)
from numpy_cae.course.exercises.exercise import (
    differentiated_exercise,
    exercise,
    operation_exercise,
)
from numpy_cae.course.solutions.lesson_06 import layer_loss, sgd_step, train_layer, zero_values
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal

P = 0.3
ALPHA = 0.4  # far above the paper's 0.01: a missing sparsity term is noticed


def loss_of_weights(x, corrupted, w, b):
    """A loss with its gradients, as simple as it can be for `train_layer`."""
    mean = np.mean(x)
    return np.sum((w - mean) ** 2) / 2 + np.sum(b**2) / 2, w - mean, 1.0 * b


LOSS_AS_TEXT = (
    "lambda x, corrupted, w, b: "
    "((((w - x.mean()) ** 2).sum() + (b**2).sum()) / 2, w - x.mean(), 1.0 * b)"
)


def _corruption_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    count = int(np.prod(shape))
    even = (np.arange(count) + 0.5) / count
    return {"x": spread(rng, shape), "p": P, "draws": rng.permutation(even.reshape(shape))}


def _loss_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = lesson_05.uniform(rng, (case["batch"], case["frames"], case["channels"]), 1.0)
    corrupted = x + lesson_05.uniform(rng, x.shape, 0.25)  # zeros would tie in the pooling
    weights = lesson_05.random_weights(case, rng)
    first = rng.random((case["batch"], case["frames"] // 2, case["filters"])) < 0.5
    arrays = {"x": x, "corrupted": corrupted, **weights, "first": first}
    return {**arrays, "alpha": ALPHA, "bound": lesson_05.BOUND}


def _training_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    windows = spread(rng, (case["windows"], 4, 5))
    weights = {"w": spread(rng, (1, 5, 2)), "b": spread(rng, (2,))}
    loss = Recorded(LOSS_AS_TEXT, loss_of_weights)
    sizes = {"loss": loss, "epochs": case["epochs"], "batch": case["batch"]}
    return {"windows": windows, **weights, **sizes, "rate": 0.5, "decay": 0.7, "p": P, "rng": rng}


def _epochs_of_calls(train_layer, given: dict) -> tuple[tuple, list[list]]:
    """What the function returns, and the calls of the loss in each epoch."""
    returned = require_parts(train_layer(*given.values()), ("weights", "losses"))
    epochs = given["epochs"]
    calls = [[*map(np.array, (*called, *found))] for *called, found in given["loss"].calls]
    steps = -(-len(given["windows"]) // given["batch"])
    if len(calls) != steps * epochs:
        expected = f"expected {steps * epochs}, once for each batch"
        raise AssertionError(f"in {epochs} epochs it calls loss {len(calls)} times, {expected}")
    return returned, [calls[steps * n : steps * (n + 1)] for n in range(epochs)]


@states("every window", "loss gets each clean window once an epoch, in a new random order")
def _every_window_once(train_layer, case, **given):
    _, epochs = _epochs_of_calls(train_layer, given)
    orders = [given["windows"][:, 0, 0].tolist()]
    for number, calls in enumerate(epochs):
        if any((x == 0).any() for x, *_ in calls):  # no value of a clean window is 0
            raise AssertionError("the x that loss gets is not clean; is it the corrupted one?")
        order = np.concatenate([x[:, 0, 0] for x, *_ in calls])
        require_equal(f"sorted x[:, 0, 0] of epoch {number}", np.sort(order), np.sort(orders[0]))
        if order.tolist() in orders:
            raise AssertionError(f"epoch {number} has the order of windows or of an earlier epoch")
        orders.append(order.tolist())


@states("corruption", "about the share p of each batch is set to zero, newly drawn")
def _corrupted_anew(train_layer, case, **given):
    _, epochs = _epochs_of_calls(train_layer, given)
    lost = {}
    for x, corrupted, *_ in (call for calls in epochs for call in calls):
        require_equal("where corrupted is not 0, it", corrupted, np.where(corrupted == 0, 0, x))
        for window, zeroed in zip(x, corrupted == 0, strict=True):
            if any(np.array_equal(zeroed, before) for before in lost.get(window[0, 0], ())):
                raise AssertionError("a window loses the same values in two epochs")
            lost.setdefault(window[0, 0], []).append(zeroed)
    share = np.mean([*lost.values()])
    if abs(share - P) > 0.15:
        raise AssertionError(f"p is {P}, but {share:.0%} of all values are zero")


@states("steps", "each step starts from the last one's w and b; epoch e has rate · decay^e")
def _steps_descend(train_layer, case, **given):
    (weights, _), epochs = _epochs_of_calls(train_layer, given)
    pairs = weights if isinstance(weights, tuple | list) else ()
    if [isinstance(pair, tuple | list) for pair in pairs] != [True] * len(epochs):
        raise AssertionError("weights has to be a list with (w, b) for each epoch")
    w, b = given["w"], given["b"]
    for number, calls in enumerate(epochs):
        for _, _, w_before, b_before, _, dw, db in calls:
            names = (f"w in epoch {number}", f"b in epoch {number}")
            require_same((w_before, b_before), (w, b), names)
            rate = given["rate"] * given["decay"] ** number
            w = w - rate * dw
            b = b - rate * db
        require_same(weights[number], (w, b), (f"w after epoch {number}", "b"))


@states("losses", "losses has the plain mean of the numbers that loss returned in each epoch")
def _mean_losses(train_layer, case, **given):
    (_, losses), epochs = _epochs_of_calls(train_layer, given)
    require_equal("losses", losses, [np.mean([call[4] for call in calls]) for calls in epochs])


EXERCISES = (
    operation_exercise("mean_squared_error"),
    operation_exercise("mean_absolute"),
    exercise(
        zero_values,
        _corruption_arguments,
        {"batch": (1, 2), "frames": (1, 2, 5), "channels": (1, 2, 3)},
        value="0 where the draw is below p, x everywhere else",
    ),
    exercise(
        sgd_step,
        drawn(
            parameter="taps channels",
            gradient="taps channels",
            rate=0.5,
            decay=0.9,
            epoch=size("epoch"),
        ),
        {"taps": (1, 3), "channels": (1, 2), "epoch": (0, 1, 2, 7)},
        value="θ - η_0 · decay^epoch · dL/dθ",
    ),
    differentiated_exercise(
        layer_loss,
        _loss_arguments,
        ("w", "b"),
        ("the loss", "dw", "db"),
        lesson_05.SIZES,
        value="the loss is that of equation 3",
        gradients={"gradient for w": ("w",), "gradient for b": ("b",)},
        given=(
            "arctanh conv1d max_pool tanh transpose_filters unpool_random decode_layer encode_layer"
        ),
    ),
    exercise(
        train_layer,
        _training_arguments,
        {"windows": (8, 9, 11), "batch": (1, 2, 3), "epochs": (2, 3)},
        _every_window_once,
        _corrupted_anew,
        _steps_descend,
        _mean_losses,
    ),
)
