"""The exercises of lesson 07, going deep: frames that a unit depends on, stages, the stack."""

from itertools import pairwise

import numpy as np

from numpy_cae.course.exercises.checks import drawn, require_parts, size, states
from numpy_cae.course.exercises.exercise import differentiated_exercise, exercise
from numpy_cae.course.exercises.lesson_05 import BOUND, uniform
from numpy_cae.course.solutions.lesson_07 import frames_seen, stack_loss, stage_inputs
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.property import require_equal

SIZES = {
    "batch": (1, 2),
    "units": (1, 2),
    "channels": (1, 2, 3),
    "filters": (1, 2, 3),
    "taps": (1, 3),
    "layers": (1, 2, 3),
}


def _random_layers(case: Case, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    channels = [case["channels"]] + case["layers"] * [case["filters"]]
    return [
        (uniform(rng, (case["taps"], below, above), 0.5), uniform(rng, (above,), 0.25))
        for below, above in pairwise(channels)
    ]


def _random_windows(case: Case, rng: np.random.Generator) -> np.ndarray:
    frames = case["units"] * 2 ** case["layers"]
    return uniform(rng, (case["batch"], frames, case["channels"]), 1.0)


_stage_arguments = drawn(x=_random_windows, layers=_random_layers)


def _stack_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = _random_windows(case, rng)
    corrupted = x + uniform(rng, x.shape, 0.25)  # zeros would tie in the pooling
    return {"x": x, "corrupted": corrupted, "layers": _random_layers(case, rng), "bound": BOUND}


@states("value", "it is the number of frames counted by following every index down")
def _count_of_indices(function, case, taps, layers):
    """Pooling reads a pair of frames, a filter one frame and K//2 more on either side."""
    read = {1000}
    for _ in range(layers):
        read = {2 * t + pair for t in read for pair in (0, 1)}
        read = {t + k - taps // 2 for t in read for k in range(taps)}
    require_equal("the number of frames", function(taps, layers), len(read))


@states("value", "the input of layer k is x encoded by every layer below k")
def _each_stage(function, case, x, layers):
    names = [f"the input of layer {number}" for number in range(1, len(layers) + 1)]
    returned = require_parts(function(x, layers), names)
    for what, found, expected in zip(names, returned, stage_inputs(x, layers), strict=True):
        require_equal(what, found, expected)


IN_LAYERS = {of: tuple(f"layers[{n}][{i}]" for n in range(3)) for i, of in enumerate("wb")}
"""The names of w or b of every layer in a message."""

EXERCISES = (
    exercise(
        frames_seen,
        drawn(taps=size("taps"), layers=size("layers")),
        {"taps": (1, 3, 5, 15), "layers": (1, 2, 3, 4)},
        _count_of_indices,
        pure=False,
    ),
    exercise(stage_inputs, _stage_arguments, SIZES, _each_stage, given="encode_layer decode_layer"),
    differentiated_exercise(
        stack_loss,
        _stack_arguments,
        ("layers",),
        ("the loss", "the gradients"),
        SIZES,
        value="the loss is the mean squared error of the whole stack",
        gradients={f"gradients for {of}": IN_LAYERS[of] for of in "wb"},
        given=(
            "conv1d transpose_filters max_pool unpool_even unpool_random tanh arctanh "
            "mean_squared_error mean_absolute layer_loss sgd_step train_layer zero_values"
        ),
    ),
)
