"""The exercises of lesson 04, pooling and its two inverses."""

from __future__ import annotations

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.exercise import Exercise, exercise, operation_exercise
from numpy_cae.verify.operation import OPERATIONS

UNPOOL = OPERATIONS["unpool_random"]


def pooled_again(y: np.ndarray, first: np.ndarray) -> np.ndarray:
    """max_pool(unpool_random(y, first)), computed with the operations themselves."""
    unpooled, _ = ops.unpool_random(y, first)
    pooled, _ = ops.max_pool(unpooled)
    return pooled


EXERCISES: tuple[Exercise, ...] = (
    operation_exercise(
        "max_pool",
        "x[:, 0::2] are the earlier frames of all pairs, x[:, 1::2] the later ones; the pullback "
        "only has to remember which of them was larger",
        hints={
            "gradient for x": "dx is twice as long as dy, and half of it is 0",
            "ties": "choose between > and >=: exactly one of two equal frames gets the gradient",
        },
    ),
    operation_exercise(
        "unpool_even",
        "half of each value is written to two frames, so its gradient is a sum of two halves",
    ),
    operation_exercise(
        "unpool_random",
        "fill the earlier and the later frames in one line each, with the mask and its negation",
        hints={"empty slot": "an array from np.empty is not initialised"},
    ),
    exercise(
        pooled_again,
        "write one pair down, once with y = 2 and once with y = -2: what is the larger of the two "
        "frames?",
        UNPOOL.arguments,
        UNPOOL.sizes,
        value="it is the result of max_pool applied to unpool_random(y, first)",
    ),
)
