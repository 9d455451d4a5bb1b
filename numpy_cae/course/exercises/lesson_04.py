"""The exercises of lesson 04, pooling and its two inverses."""

from __future__ import annotations

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.exercise import (
    Claim,
    Exercise,
    exercise,
    operation_exercise,
    same_as,
    unaltered,
)
from numpy_cae.verify.operation import OPERATIONS

_random = OPERATIONS["unpool_random"]


def pooled_again(y: np.ndarray, first: np.ndarray) -> np.ndarray:
    """max_pool(unpool_random(y, first)), by way of the operations themselves."""
    unpooled, _ = ops.unpool_random(y, first)
    pooled, _ = ops.max_pool(unpooled)
    return pooled


EXERCISES: tuple[Exercise, ...] = (
    operation_exercise(
        "max_pool",
        "x[:, 0::2] are the earlier frames of all pairs, x[:, 1::2] the later ones; which of them "
        "won is all that the pullback has to remember",
        hints={
            "gradient for x": "dx is twice as long as dy, and half of it is 0",
            "ties": "with > or >=, one of two equal frames must win, and only one",
        },
    ),
    operation_exercise(
        "unpool_even",
        "each value stands in two frames, at half its size each time: its gradient is a sum of two",
    ),
    operation_exercise(
        "unpool_random",
        "fill the earlier and the later frames in one line each, with the mask and its negation",
        hints={"empty slot": "an array from np.empty holds whatever was in memory"},
    ),
    exercise(
        "pooled_again",
        "write one pair down, once with y = 2 and once with y = -2: what is the larger of the two "
        "frames?",
        pooled_again,
        _random.arguments,
        _random.sizes,
        (
            Claim(
                "value",
                "it is what max_pool makes of unpool_random(y, first)",
                same_as(pooled_again, _random.arguments),
                2,
            ),
            unaltered(_random.arguments),
        ),
    ),
)
