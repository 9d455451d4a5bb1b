"""The checks and arguments of lesson 07b, better steps: momentum, Adam and a one-cycle rate."""

import numpy as np

from numpy_cae.verify.operations.case import Case, spread


def squares(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """A mean of squares, which is positive."""
    return spread(rng, (case["taps"], case["channels"])) ** 2
