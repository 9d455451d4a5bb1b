"""The exercises of lesson 11, matching distributions: one dimension, slices, the whole loss."""

from itertools import permutations

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises import lesson_10
from numpy_cae.course.exercises.checks import Differentiated, array, drawn
from numpy_cae.course.exercises.exercise import (
    differentiated_exercise,
    exercise,
    operation_exercise,
)
from numpy_cae.course.exercises.lesson_05 import uniform
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import Operation, definitions

WEIGHT = 0.7  # large beside the lesson's, so that a missing term is noticed


def wasserstein_1d(p, q):
    """The squared 2-Wasserstein distance of two sets of numbers, and its pullback."""
    one_direction = np.ones((1, 1), p.dtype)
    loss, back = ops.sliced_wasserstein(p[:, None], q[:, None], one_direction)
    return loss, lambda dloss=1.0: back(dloss)[:, 0]


def unit_rows(rows):
    """Each row divided by its length."""
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def regularised_loss(weights, x, prior, directions, weight):
    """Reconstruction and λ times the discrepancy, and its derivatives, from the package."""
    model = SequentialAutoencoder.from_weights(weights)
    losses, gradients = model.loss_and_gradients(x, prior, directions, weight)
    return x.dtype.type(losses.total), gradients


def _cheapest_assignment(p, q):
    """The least mean square of the gaps over all assignments."""
    return min(np.mean((p - q[list(order)]) ** 2) for order in permutations(range(len(q))))


def _regularised_by_loops(weights, x, prior, directions, weight):
    discrepancy = definitions.sliced_wasserstein(
        lesson_10.read_by_loops(weights, x), prior, directions
    )
    return lesson_10.reconstruction_by_loops(weights, x) + weight * discrepancy


def _loss_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    return {
        "weights": lesson_10.random_weights(case, rng),
        "x": lesson_10.random_clips(case, rng),
        "prior": uniform(rng, (case["batch"], case["latent"]), 1.0),
        "directions": unit_rows(uniform(rng, (case["directions"], case["latent"]), 1.0)),
        "weight": WEIGHT,
    }


LOSS = Differentiated(
    _loss_arguments, _regularised_by_loops, ("weights",), lesson_10.LOSS_AND_GRADIENTS
)

EXERCISES = (
    operation_exercise(
        Operation(
            "wasserstein_1d",
            {"points": (1, 2, 3, 4, 5)},
            drawn(p="points", q=array("points", 1.3)),
            ("p",),
            _cheapest_assignment,
        ),
        wasserstein_1d,
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
        LOSS,
        {**lesson_10.WHOLE_NETWORK, "directions": (1, 2)},
        value="the loss is reconstruction + λ · discrepancy, computed by loops",
        gradients={
            "gradients of writing": (2, lesson_10.DECODER),
            "gradients of reading": (4, lesson_10.ENCODER),
        },
        float32=True,
        given="clip_gradients mean_squared_error read_clips write_clips",
    ),
)
