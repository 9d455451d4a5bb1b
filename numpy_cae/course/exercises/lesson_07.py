"""The checks and arguments of lesson 07, going deep: frames that a unit depends on, the stack."""

from itertools import pairwise

import numpy as np

from numpy_cae.course.exercises.arguments import uniform
from numpy_cae.course.exercises.checks import checks, require_same
from numpy_cae.course.exercises.lesson_06 import corrupted as corrupted
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


@checks("frames_seen", "value")
def _count_of_indices(function, case, taps, layers):
    """Pooling reads a pair of frames, a filter one frame and K//2 more on either side."""
    read = {1000}
    for _ in range(layers):
        read = {2 * t + pair for t in read for pair in (0, 1)}
        read = {t + k - taps // 2 for t in read for k in range(taps)}
    require_same(function(taps, layers), len(read), ("the number of frames",))
