"""The exercises of lesson 05, one layer: equations 1 and 2, and both with the same W and b."""

import numpy as np

from numpy_cae.course.exercises.exercise import composed_exercise, operation_exercise
from numpy_cae.course.solutions.lesson_05 import decode_layer, encode_layer, project_layer
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.operation import FILTERS, WINDOW

SIZES = {**WINDOW, **FILTERS, "frames": (2, 4, 6), "taps": (1, 3, 5)}
BOUND, SMALL = 0.9, 8


def uniform(rng: np.random.Generator, shape: tuple[int, ...], bound: float) -> np.ndarray:
    """Entries between -bound and bound: of many, uniform ones, whose sums do not tie."""
    is_small = np.prod(shape) <= SMALL
    return spread(rng, shape, bound) if is_small else rng.uniform(-bound, bound, shape).round(3)


def random_weights(case: Case, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Filters and biases of eighths if few; most hidden values stay inside the bound."""
    shape = (case["taps"], case["channels"], case["filters"])
    return {"w": uniform(rng, shape, 0.5), "b": uniform(rng, shape[2:], 0.5)}


def _window_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = uniform(rng, (case["batch"], case["frames"], case["channels"]), 1.0)
    return {"x": x, **random_weights(case, rng)}


def _hidden_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    y = spread(rng, (case["batch"], case["frames"], case["filters"]), 1.25)
    return {"y": y, **random_weights(case, rng), "bound": BOUND}


EXERCISES = (
    operation_exercise("tanh"),
    operation_exercise("arctanh"),
    composed_exercise(encode_layer, _window_arguments, "x w b", SIZES, given="conv1d max_pool"),
    composed_exercise(
        decode_layer,
        _hidden_arguments,
        "y w b",
        SIZES | {"frames": (1, 2, 3)},
        given="conv1d transpose_filters unpool_even",
    ),
    composed_exercise(
        project_layer, lambda case: {**_window_arguments(case), "bound": BOUND}, "x w b", SIZES
    ),
)
