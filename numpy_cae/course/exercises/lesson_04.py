"""The exercises of lesson 04, pooling and its two inverses."""

from numpy_cae.course.exercises.exercise import exercise, operation_exercise
from numpy_cae.course.solutions.lesson_04 import pooled_again
from numpy_cae.verify.operations.operation import OPERATIONS

UNPOOL = OPERATIONS["unpool_random"]


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
