"""The exercises of lesson 03, convolution by hand."""

from collections.abc import Callable

import numpy as np

from numpy_cae.course.exercises.checks import drawn, size, states
from numpy_cae.course.exercises.exercise import exercise, operation_exercise
from numpy_cae.course.solutions.lesson_03 import conv1d_by_loops, unfold
from numpy_cae.verify.operations.catalogue import Exercise
from numpy_cae.verify.operations.operation import OPERATIONS

CONV1D = OPERATIONS["conv1d"]


@states("dtype", "float32 stays float32", is_form=True)
def _keeps_float32(function, case, x, taps):
    dtype = np.asarray(function(x.astype(np.float32), taps)).dtype
    if dtype != np.float32:
        raise AssertionError(f"given float32, the rows are {dtype}")


def convolution_exercise(solution: Callable, given: str = "") -> Exercise:
    """An exercise whose value is that of `ops.conv1d`, without a pullback."""
    value = "y[t] = Σ_k x[t + k - K//2] w[k] + b, zeros beyond both ends"
    return exercise(solution, CONV1D.arguments, CONV1D.sizes, value=value, given=given)


EXERCISES = (
    convolution_exercise(conv1d_by_loops),
    exercise(
        unfold,
        drawn(x="batch frames channels", taps=size("taps")),
        {name: CONV1D.sizes[name] for name in ("batch", "frames", "channels", "taps")},
        _keeps_float32,
        value="row t holds x[t - K//2], ..., x[t + K//2], frame after frame",
    ),
    operation_exercise("transpose_filters"),
    operation_exercise("conv1d"),
)
