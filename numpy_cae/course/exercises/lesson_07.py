"""The arguments of lesson 07, going deep: the windows and the layers of a stack."""

from itertools import pairwise

import numpy as np

from numpy_cae.course.exercises.arguments import uniform
from numpy_cae.verify.operations.case import Case


def random_layers(case: Case, rng: np.random.Generator, made: dict) -> list[tuple]:
    """The filters and biases of each layer."""
    channels = [case["channels"]] + case["layers"] * [case["filters"]]
    return [
        (uniform(rng, (case["taps"], below, above), 0.5), uniform(rng, (above,), 0.25))
        for below, above in pairwise(channels)
    ]


def random_windows(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Windows whose frames can be pooled in every layer."""
    frames = case["units"] * 2 ** case["layers"]
    return uniform(rng, (case["batch"], frames, case["channels"]), 1.0)
