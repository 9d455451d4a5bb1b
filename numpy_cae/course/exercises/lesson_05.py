"""The exercises of lesson 05, one layer: equation 1, equation 2, and both with one W and one b."""

from __future__ import annotations

import numpy as np

from numpy_cae.course.exercises.exercise import Exercise, operation_exercise
from numpy_cae.models import ConvLayer
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.operation import FILTERS, WINDOW, Operation

SIZES = {**WINDOW, **FILTERS, "frames": (1, 2, 3), "taps": (1, 3, 5)}
BOUND = 0.9


def scattered(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    """Entries between -reach and reach with all their digits: `spread` would tie in a sum."""
    return rng.uniform(-reach, reach, shape)


def drawn_weights(case: Case, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Filters and biases small enough that not every hidden unit sits at the bound."""
    shape = (case["taps"], case["channels"], case["filters"])
    return {"w": scattered(rng, shape, 0.6), "b": scattered(rng, shape[2:], 0.4)}


def _windows_and_weights(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = scattered(rng, (case["batch"], 2 * case["frames"], case["channels"]), 1.0)
    return {"x": x, **drawn_weights(case, rng)}


def _units_and_weights(case: Case) -> dict[str, object]:
    rng = case.rng()
    y = spread(rng, (case["batch"], case["frames"], case["filters"]), 1.21)
    return {"y": y, **drawn_weights(case, rng), "bound": BOUND}


def encoded(x, w, b):
    """Equation 1, loop by loop."""
    return definitions.tanh_(definitions.max_pool(definitions.conv1d(x, w, b)))


def decoded(y, w, b, bound):
    """Equation 2 with even unpooling, loop by loop."""
    unpooled = definitions.unpool_even(definitions.arctanh(y, bound))
    w_tilde = definitions.transpose_filters(w)
    return definitions.conv1d(unpooled - b, w_tilde, np.zeros(w.shape[1]))


def encode_layer(x, w, b):
    """Equation 1 and its pullback, from the package."""
    return ConvLayer(w, b, BOUND).encode_with_pullback(x)


def decode_layer(y, w, b, bound):
    """Equation 2 and its pullback, from the package."""
    return ConvLayer(w, b, bound).decode_with_pullback(y)


def project_layer(x, w, b, bound):
    """Equation 2 of equation 1, W and b tied, from the package."""
    layer = ConvLayer(w, b, bound)
    y, encode_back = layer.encode_with_pullback(x)
    x_hat, decode_back = layer.decode_with_pullback(y)

    def pullback(dx_hat):
        dy, dw_down, db_down = decode_back(dx_hat)
        dx, dw_up, db_up = encode_back(dy)
        return dx, dw_up + dw_down, db_up + db_down

    return x_hat, pullback


EXERCISES: tuple[Exercise, ...] = (
    operation_exercise(
        "tanh",
        "the slope of tanh is 1 - tanh²: keep what you have computed",
    ),
    operation_exercise(
        "arctanh",
        "clip first, then invert. The slope of arctanh at y is 1 / (1 - y²); ask yourself how much "
        "the clipped number moves when y is beyond the bound",
        hints={"beyond the bound": "clip(2.0) and clip(2.1) are the same number"},
    ),
    operation_exercise(
        Operation(
            "encode_layer",
            SIZES,
            _windows_and_weights,
            ("x", "w", "b"),
            encoded,
        ),
        "call the three operations of equation 1 from the inside out and keep each one's pullback; "
        "the gradient passes them in the reverse order",
        encode_layer,
        given=("conv1d", "max_pool"),
        hints={"value": "convolve, pool, then tanh: tanh is outermost in equation 1"},
    ),
    operation_exercise(
        Operation(
            "decode_layer",
            SIZES,
            _units_and_weights,
            ("y", "w", "b"),
            decoded,
        ),
        "four steps in the order of equation 2: arctanh, unpool, subtract b, convolve with W̃. "
        "The convolution's own bias is zeros, one for each channel that comes out",
        decode_layer,
        given=("conv1d", "transpose_filters", "unpool_even"),
        hints={
            "value": "b is subtracted whole, after unpooling, and nothing is added at the end",
            "gradient for w": "the convolution returns dL/dW̃: send it through the pullback of "
            "transpose_filters",
            "gradient for b": "b is subtracted from every frame of every window",
        },
    ),
    operation_exercise(
        Operation(
            "project_layer",
            SIZES,
            lambda case: {**_windows_and_weights(case), "bound": BOUND},
            ("x", "w", "b"),
            lambda x, w, b, bound: decoded(encoded(x, w, b), w, b, bound),
        ),
        "W and b are used twice, and a small change of W changes the result through both uses",
        project_layer,
        hints={
            "gradient for w": "add what encoding says about W to what decoding says about W",
            "gradient for b": "add both shares; the one of decoding has its own sign already",
        },
    ),
)
