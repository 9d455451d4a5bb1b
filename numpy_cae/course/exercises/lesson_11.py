"""The arguments of lesson 11, matching distributions."""

import numpy as np

from numpy_cae.course.exercises.arguments import uniform
from numpy_cae.course.exercises.lesson_10 import random_weights as random_weights
from numpy_cae.course.solutions.lesson_11 import unit_rows
from numpy_cae.verify.operations.case import Case


def random_directions(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Unit vectors, one a row."""
    return unit_rows(uniform(rng, (case["directions"], case["latent"]), 1.0))
