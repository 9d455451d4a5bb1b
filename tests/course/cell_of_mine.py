"""What `course.solved` saves of the cell of an exercise: functions, constants and imports."""

import math  # noqa: F401 -- a student's cell

import numpy as np

HALF, unused = 0.5, print("shown")
HALF = 0.5


def half(y):
    return HALF * y


def unpool_even(y):
    def pullback(dx):
        return half(dx.reshape(len(y), y.shape[1], 2, -1).sum(axis=2))

    return np.repeat(half(y), 2, axis=1), pullback


print(unpool_even(np.ones((1, 2, 3))))
