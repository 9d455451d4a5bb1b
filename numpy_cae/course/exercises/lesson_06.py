"""The checks and arguments of lesson 06, learning: corruption, and the loop over epochs."""

import numpy as np

from numpy_cae.course.exercises.arguments import uniform
from numpy_cae.course.exercises.checks import checks, require_parts, require_same
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.property import require_equal

LOSS = (
    "lambda x, corrupted, w, b: "
    "((((w - x.mean()) ** 2).sum() + (b**2).sum()) / 2, w - x.mean(), 1.0 * b)"
)
"""LOSS: a loss with its gradients, as simple as it can be for `train_layer`."""


def corrupted(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Windows with noise: zeros would tie in the pooling."""
    return made["x"] + uniform(rng, made["x"].shape, 0.25)


def first_frames(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Where a value is unpooled to the first frame of its pair."""
    return rng.random((case["batch"], case["frames"] // 2, case["filters"])) < 0.5


def generator(case: Case, rng: np.random.Generator, made: dict) -> np.random.Generator:
    """What draws the arguments."""
    return rng


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


@checks("train_layer", "every window")
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


@checks("train_layer", "corruption")
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
    if abs(share - given["p"]) > 0.15:
        raise AssertionError(f"p is {given['p']}, but {share:.0%} of all values are zero")


@checks("train_layer", "steps")
def _steps_descend(train_layer, case, **given):
    (weights, _), epochs = _epochs_of_calls(train_layer, given)
    pairs = weights if isinstance(weights, tuple | list) else ()
    if [isinstance(pair, tuple | list) for pair in pairs] != [True] * len(epochs):
        raise AssertionError("weights has to be a list with (w, b) for each epoch")
    w = given["w"]
    b = given["b"]
    for number, calls in enumerate(epochs):
        for _, _, w_before, b_before, _, dw, db in calls:
            names = (f"w in epoch {number}", f"b in epoch {number}")
            require_same((w_before, b_before), (w, b), names)
            rate = given["rate"] * given["decay"] ** number
            w = w - rate * dw
            b = b - rate * db
        require_same(weights[number], (w, b), (f"w after epoch {number}", "b"))


@checks("train_layer", "losses")
def _mean_losses(train_layer, case, **given):
    (_, losses), epochs = _epochs_of_calls(train_layer, given)
    require_equal("losses", losses, [np.mean([call[4] for call in calls]) for calls in epochs])
