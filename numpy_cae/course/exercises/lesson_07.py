"""The exercises of lesson 07, going deep: what a unit sees, what a layer learns from, the stack."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from numpy_cae.course.exercises.exercise import Claim, Exercise, exercise, unaltered
from numpy_cae.course.exercises.lesson_05 import BOUND, decoded, encoded, scattered
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case
from numpy_cae.verify.gradients import check_gradients
from numpy_cae.verify.property import require_equal

SIZES = {
    "batch": (1, 2),
    "units": (1, 2),
    "channels": (1, 2, 3),
    "filters": (1, 2, 3),
    "taps": (1, 3),
    "layers": (1, 2, 3),
}


def frames_seen(taps, layers):
    """Frames of motion that one unit of the top layer depends on."""
    return 1 + taps * (2**layers - 1)


def stage_inputs(x, layers):
    """The clean input that each layer learns to reproduce, lowest first."""
    inputs = [x]
    for w, b in layers[:-1]:
        inputs.append(ConvLayer(w, b, BOUND).encode_with_pullback(inputs[-1])[0])
    return inputs


def stack_loss(x, corrupted, layers, bound):
    """Equation 3 of the whole stack with α = 0, and its derivatives, from the package."""
    model = ConvAutoencoder.from_layers([ConvLayer(w, b, bound) for w, b in layers])
    return model.loss_and_gradients(x, corrupted)


def _layers(case: Case, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    channels = [case["channels"]] + case["layers"] * [case["filters"]]
    return [
        (scattered(rng, (case["taps"], below, above), 0.6), scattered(rng, (above,), 0.3))
        for below, above in pairwise(channels)
    ]


def _windows(case: Case, rng: np.random.Generator) -> np.ndarray:
    frames = case["units"] * 2 ** case["layers"]
    return scattered(rng, (case["batch"], frames, case["channels"]), 1.0)


def _seen(case: Case) -> dict[str, object]:
    return {"taps": case["taps"], "layers": case["layers"]}


def _inputs(case: Case) -> dict[str, object]:
    rng = case.rng()
    return {"x": _windows(case, rng), "layers": _layers(case, rng)}


def _stack(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = _windows(case, rng)
    corrupted = x + scattered(rng, x.shape, 0.3)  # zeros would tie in the pooling
    return {"x": x, "corrupted": corrupted, "layers": _layers(case, rng), "bound": BOUND}


def _counted(frames_seen, case: Case) -> None:
    """Counts by following the indices down: pooling reads a pair, a filter a frame and K//2 more
    on either side."""
    read = {1000}
    for _ in range(case["layers"]):
        read = {2 * t + pair for t in read for pair in (0, 1)}
        beyond = range(-(case["taps"] // 2), case["taps"] // 2 + 1)
        read = {t + k for t in read for k in beyond}
    require_equal("the number of frames", frames_seen(*_seen(case).values()), len(read))


def _each_input(stage_inputs, case: Case) -> None:
    x, layers = _inputs(case).values()
    found = stage_inputs(x, layers)
    if not isinstance(found, tuple | list) or len(found) != len(layers):
        raise AssertionError(f"expected a list of {len(layers)} arrays, one for each layer")
    expected = x
    for number, ((w, b), one) in enumerate(zip(layers, found, strict=True), 1):
        require_equal(f"the input of layer {number}", one, expected)
        expected = encoded(expected, w, b)


def _defined_loss(x, corrupted, layers, bound):
    y = corrupted
    for w, b in layers:
        y = encoded(y, w, b)
    for w, b in reversed(layers):
        y = decoded(y, w, b, bound)
    return definitions.mean_squared_error(y, x)


def _loss(stack_loss, case: Case) -> None:
    arguments = _stack(case)
    loss, _ = _pair(stack_loss(*arguments.values()), case)
    require_equal("the loss", loss, _defined_loss(**arguments))


def _gradients(position: int):
    """Checks every layer's gradient for w (position 0) or for b (position 1)."""

    def check(stack_loss, case: Case) -> None:
        x, corrupted, layers, bound = _stack(case).values()

        def f(*parameters):
            layers = list(zip(parameters[0::2], parameters[1::2], strict=True))
            loss, gradients = _pair(stack_loss(x, corrupted, layers, bound), case)
            return np.float64(loss), lambda d: tuple(d * g for pair in gradients for g in pair)

        names = [f"{of} of layer {n}" for n in range(1, case["layers"] + 1) for of in "wb"]
        parameters = [parameter for pair in layers for parameter in pair]
        check_gradients(f, *parameters, rng=case.rng(), names=names, only=names[position::2])

    return check


def _pair(returned, case: Case):
    if not (isinstance(returned, tuple | list) and len(returned) == 2):
        raise AssertionError("it does not return two things: the loss and a list of gradients")
    if not isinstance(returned[1], tuple | list) or len(returned[1]) != case["layers"]:
        raise AssertionError(f"expected {case['layers']} pairs (dw, db), one for each layer")
    return returned


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "frames_seen",
        "go down one layer at a time: how many frames of the convolution do n neighbouring units "
        "read, and how many frames below do those read?",
        frames_seen,
        _seen,
        {"taps": (1, 3, 5, 15), "layers": (1, 2, 3, 4)},
        (
            Claim(
                "value",
                "as many frames as are counted by following every index down",
                _counted,
                2,
                "2n frames of a convolution with K taps read 2n + K - 1 frames below",
            ),
        ),
    ),
    exercise(
        "stage_inputs",
        "the first layer learns from x itself; the second from what the first makes of x",
        stage_inputs,
        _inputs,
        SIZES,
        (
            Claim(
                "value",
                "the input of layer k is x encoded by every layer below k",
                _each_input,
                2,
            ),
            unaltered(_inputs),
        ),
        given=("encode_layer", "decode_layer"),
    ),
    exercise(
        "stack_loss",
        "encode with every layer, keeping the pullbacks; decode with every layer in reverse, "
        "keeping theirs. The gradient goes the same way back, through the last pullback first",
        stack_loss,
        _stack,
        SIZES,
        (
            Claim(
                "value",
                "the loss is the mean squared error of the whole stack, loop by loop",
                _loss,
                2,
                "decoding starts with the top layer",
            ),
            Claim(
                "gradients for w",
                "dw of every layer is that of central differences of your own loss",
                _gradients(0),
                4,
                "each layer's two shares must meet; the lists of pullbacks run in opposite orders",
            ),
            Claim(
                "gradients for b",
                "db of every layer is that of central differences of your own loss",
                _gradients(1),
                4,
                "each layer's two shares must meet; the lists of pullbacks run in opposite orders",
            ),
            unaltered(_stack),
        ),
        given=("encode_layer", "decode_layer", "mean_squared_error"),
    ),
)
