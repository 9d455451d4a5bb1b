"""The exercises of lesson 06, learning: equation 3, corruption, and a step of descent."""

from __future__ import annotations

import numpy as np

from numpy_cae.course.exercises.checks import Differentiated, claim, drawn, size
from numpy_cae.course.exercises.exercise import (
    Exercise,
    differentiated_exercise,
    exercise,
    operation_exercise,
)
from numpy_cae.course.exercises.lesson_05 import (
    BOUND,
    SIZES,
    decode_by_loops,
    encode_by_loops,
    random_weights,
    uniform,
)
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.training import decayed_rate
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.property import require_equal

P = 0.3
ALPHA = 0.4  # large beside the paper's 0.01, so that a missing sparsity term is noticed


def zero_values(x, p, draws):
    """X_c: 0 where the draw is below p."""
    return np.where(draws < p, x.dtype.type(0), x)


def sgd_step(parameter, gradient, rate, decay, epoch):
    """θ - η_0 · decay^epoch · dL/dθ"""
    return parameter - decayed_rate(rate, decay, epoch) * gradient


def layer_loss(x, corrupted, w, b, first, alpha, bound):
    """Equation 3 of one layer and its derivatives, from the package."""
    model = ConvAutoencoder.from_layers([ConvLayer(w, b, bound)])
    loss, [(dw, db)] = model.loss_and_gradients(x, corrupted, alpha, [first])
    return loss, dw, db


def _layer_loss_by_loops(x, corrupted, w, b, first, alpha, bound):
    y = encode_by_loops(corrupted, w, b)
    x_hat = decode_by_loops(y, w, b, bound, first)
    return definitions.mean_squared_error(x_hat, x) + alpha * definitions.mean_absolute(y)


def _corruption_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    count = int(np.prod(shape))
    even = (np.arange(count) + 0.5) / count
    return {"x": spread(rng, shape), "p": P, "draws": rng.permutation(even.reshape(shape))}


_step_arguments = drawn(
    parameter="taps channels", gradient="taps channels", rate=0.5, decay=0.9, epoch=size("epoch")
)


def _loss_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = uniform(rng, (case["batch"], 2 * case["frames"], case["channels"]), 1.0)
    corrupted = x + uniform(rng, x.shape, 0.3)  # zeros would tie in the pooling
    weights = random_weights(case, rng)
    first = rng.random((case["batch"], case["frames"], case["filters"])) < 0.5
    numbers = {"alpha": ALPHA, "bound": BOUND}
    return {"x": x, "corrupted": corrupted, **weights, "first": first, **numbers}


@claim("kept", "values that are not zeroed are exactly those of x")
def _kept_values(function, case: Case) -> None:
    x, p, draws = _corruption_arguments(case).values()
    found = function(x, p, draws)[draws >= p]
    require_equal("where the draw is not below p, the value", found, x[draws >= p])


EXERCISES: tuple[Exercise, ...] = (
    operation_exercise("mean_squared_error"),
    operation_exercise("mean_absolute"),
    exercise(
        zero_values,
        _corruption_arguments,
        {"batch": (1, 2), "frames": (1, 2, 5), "channels": (1, 2, 3)},
        _kept_values,
        value="0 where the draw is below p, x everywhere else",
        points=3,
    ),
    exercise(
        sgd_step,
        _step_arguments,
        {"taps": (1, 3), "channels": (1, 2), "epoch": (0, 1, 2, 7)},
        value="θ - η_0 · decay^epoch · dL/dθ",
    ),
    differentiated_exercise(
        layer_loss,
        Differentiated(_loss_arguments, _layer_loss_by_loops, ("w", "b"), ("the loss", "dw", "db")),
        SIZES,
        value="the loss is that of equation 3, computed by loops",
        gradients={"gradient for w": (3, ("w",)), "gradient for b": (3, ("b",))},
        given=("arctanh", "conv1d", "max_pool", "tanh", "transpose_filters", "unpool_random"),
    ),
)
