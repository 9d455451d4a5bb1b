"""The exercises of lesson 06, learning: equation 3, corruption, and a step of descent."""

from __future__ import annotations

import numpy as np

from numpy_cae.course.exercises.exercise import (
    Claim,
    Exercise,
    exercise,
    operation_exercise,
    same_as,
    unaltered,
)
from numpy_cae.course.exercises.lesson_05 import BOUND, SIZES, drawn_weights, encoded, scattered
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.training import decayed_rate
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.gradients import check_gradients
from numpy_cae.verify.property import require_equal

P = 0.3
ALPHA = 0.4  # large beside the paper's 0.01, so that a lost sparsity term shows


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


def _defined_loss(x, corrupted, w, b, first, alpha, bound):
    y = encoded(corrupted, w, b)
    unpooled = definitions.unpool_random(definitions.arctanh(y, bound), first)
    w_tilde = definitions.transpose_filters(w)
    x_hat = definitions.conv1d(unpooled - b, w_tilde, np.zeros(w.shape[1]))
    return definitions.mean_squared_error(x_hat, x) + alpha * definitions.mean_absolute(y)


def _to_zero(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    return {"x": spread(rng, shape), "p": P, "draws": rng.permutation(_evenly(shape))}


def _evenly(shape: tuple[int, ...]) -> np.ndarray:
    count = int(np.prod(shape))
    return ((np.arange(count) + 0.5) / count).reshape(shape)


def _step(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["taps"], case["channels"])
    return {
        "parameter": spread(rng, shape),
        "gradient": spread(rng, shape),
        "rate": 0.5,
        "decay": 0.9,
        "epoch": case["epoch"],
    }


def _layer(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = scattered(rng, (case["batch"], 2 * case["frames"], case["channels"]), 1.0)
    corrupted = x + scattered(rng, x.shape, 0.3)  # zeros would tie in the pooling
    weights = drawn_weights(case, rng)
    first = rng.random((case["batch"], case["frames"], case["filters"])) < 0.5
    return {
        "x": x,
        "corrupted": corrupted,
        **weights,
        "first": first,
        "alpha": ALPHA,
        "bound": BOUND,
    }


def _kept(function, case: Case) -> None:
    x, p, draws = _to_zero(case).values()
    require_equal(
        "where the draw is not below p, the value", function(x, p, draws)[draws >= p], x[draws >= p]
    )


def _loss(layer_loss, case: Case) -> None:
    arguments = _layer(case)
    require_equal(
        "the loss", _three(layer_loss(*arguments.values()))[0], _defined_loss(**arguments)
    )


def _gradient_for(name: str):
    def check(layer_loss, case: Case) -> None:
        x, corrupted, w, b, *rest = _layer(case).values()

        def f(w, b):
            loss, dw, db = _three(layer_loss(x, corrupted, w, b, *rest))
            return np.float64(loss), lambda d: (d * dw, d * db)

        check_gradients(f, w, b, rng=case.rng(), only=(name,))

    return check


def _three(returned):
    if not (isinstance(returned, tuple | list) and len(returned) == 3):
        raise AssertionError("it does not return three things: loss, dw, db")
    return returned


EXERCISES: tuple[Exercise, ...] = (
    operation_exercise(
        "mean_squared_error",
        "the mean is over every element, so each has a share of 1/N in the loss; the pullback "
        "takes the upstream number, 1.0 where none is given",
    ),
    operation_exercise(
        "mean_absolute",
        "the slope of |y| is the sign of y; at 0, where it has none, take 0",
    ),
    exercise(
        "zero_values",
        "a comparison of draws with p says where; np.where chooses",
        zero_values,
        _to_zero,
        {"batch": (1, 2), "frames": (1, 2, 5), "channels": (1, 2, 3)},
        (
            Claim(
                "value",
                "0 where the draw is below p, x everywhere else",
                same_as(zero_values, _to_zero),
                3,
            ),
            Claim("kept", "what is not lost is exactly as it was", _kept),
            unaltered(_to_zero),
        ),
    ),
    exercise(
        "sgd_step",
        "epoch 0 uses the rate as it is given; every epoch after it multiplies once more",
        sgd_step,
        _step,
        {"taps": (1, 3), "channels": (1, 2), "epoch": (0, 1, 2, 7)},
        (
            Claim("value", "θ - η_0 · decay^epoch · dL/dθ", same_as(sgd_step, _step), 2),
            unaltered(_step),
        ),
    ),
    exercise(
        "layer_loss",
        "go forward through equation 1 with X_c and equation 2 with the mask; compare with the "
        "clean X; then go back. Two gradients meet at Y: that of the error and that of the "
        "sparsity term",
        layer_loss,
        _layer,
        SIZES,
        (
            Claim(
                "value",
                "the loss is that of equation 3, loop by loop",
                _loss,
                2,
                "the error is against x, the units are those of corrupted",
            ),
            Claim(
                "gradient for w",
                "dw is that of central differences of your own loss",
                _gradient_for("w"),
                3,
                "three shares: decoding, encoding of the error, encoding of the sparsity term",
            ),
            Claim(
                "gradient for b",
                "db is that of central differences of your own loss",
                _gradient_for("b"),
                3,
                "both directions have a share in b too",
            ),
            unaltered(_layer),
        ),
        given=("arctanh", "conv1d", "max_pool", "tanh", "transpose_filters", "unpool_random"),
    ),
)
