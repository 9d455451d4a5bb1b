"""The exercises of lesson 11, matching distributions: one dimension, slices, the whole loss."""

import numpy as np

from numpy_cae.course.exercises import lesson_10
from numpy_cae.course.exercises.checks import array, drawn
from numpy_cae.course.exercises.exercise import (
    composed_exercise,
    differentiated_exercise,
    exercise,
    operation_exercise,
)
from numpy_cae.course.exercises.lesson_05 import uniform
from numpy_cae.course.solutions.lesson_11 import regularised_loss, unit_rows, wasserstein_1d
from numpy_cae.verify.operations.case import Case

WEIGHT = 0.7  # far above the lesson's: a missing term is noticed


def _random_directions(case: Case, rng: np.random.Generator) -> np.ndarray:
    return unit_rows(uniform(rng, (case["directions"], case["latent"]), 1.0))


_loss_arguments = drawn(
    weights=lesson_10.random_weights,
    x=lesson_10.random_clips,
    prior=lesson_10.random_latent,
    directions=_random_directions,
    weight=WEIGHT,
)


EXERCISES = (
    composed_exercise(
        wasserstein_1d, drawn(p="points", q=array("points", 1.3)), "p", {"points": (1, 2, 3, 4, 5)}
    ),
    exercise(
        unit_rows,
        drawn(rows="directions dimensions"),
        {"directions": (1, 2, 3), "dimensions": (1, 2, 3)},
        value="each row is divided by its own length",
    ),
    operation_exercise("sliced_wasserstein"),
    differentiated_exercise(
        regularised_loss,
        _loss_arguments,
        ("weights",),
        lesson_10.LOSS_AND_GRADIENTS,
        {**lesson_10.WHOLE_NETWORK, "directions": (1, 2)},
        value="the loss is reconstruction + λ · discrepancy",
        gradients={
            "gradients of writing": lesson_10.DECODER,
            "gradients of reading": lesson_10.ENCODER,
        },
        float32=True,
        given="clip_gradients mean_squared_error read_clips write_clips",
    ),
)
