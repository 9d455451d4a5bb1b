"""The exercises of lesson 04, pooling and its two inverses."""

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.exercise import exercise, operation_exercise
from numpy_cae.verify.operations.operation import OPERATIONS

UNPOOL = OPERATIONS["unpool_random"]


def pooled_again(y: np.ndarray, first: np.ndarray) -> np.ndarray:
    """max_pool(unpool_random(y, first)), computed with the operations themselves."""
    unpooled, _ = ops.unpool_random(y, first)
    pooled, _ = ops.max_pool(unpooled)
    return pooled


EXERCISES = (
    operation_exercise("max_pool", given="conv1d"),
    operation_exercise("unpool_even"),
    operation_exercise("unpool_random"),
    exercise(
        pooled_again,
        UNPOOL.arguments,
        UNPOOL.sizes,
        value="it is the result of max_pool applied to unpool_random(y, first)",
    ),
)
