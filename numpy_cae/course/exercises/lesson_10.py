"""The arguments of lessons 10 and 11, a manifold in sequences: weights, and directions."""

import numpy as np

from numpy_cae.course.exercises.arguments import uniform
from numpy_cae.course.solutions.lesson_11 import unit_rows
from numpy_cae.models.sequential_autoencoder import Weights, weight_shapes
from numpy_cae.verify.operations.case import Case

OF_ENCODER = ("encoder_", "latent_")


def random_weights(case: Case, rng: np.random.Generator, made: dict) -> Weights:
    """Every weight of the network by name."""
    shapes = weight_shapes(case["features"], case["hidden"], case["latent"])
    return {name: uniform(rng, shape, 1.0) for name, shape in shapes.items()}


def encoder(case: Case, rng: np.random.Generator, made: dict) -> Weights:
    """The weights from clips to z."""
    every = random_weights(case, rng, made)
    return {name: weight for name, weight in every.items() if name.startswith(OF_ENCODER)}


def decoder(case: Case, rng: np.random.Generator, made: dict) -> Weights:
    """The weights from z to clips."""
    every = random_weights(case, rng, made)
    return {name: weight for name, weight in every.items() if not name.startswith(OF_ENCODER)}


def random_directions(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Unit vectors, one a row."""
    return unit_rows(rng.uniform(-1.0, 1.0, (case["directions"], case["latent"])))
