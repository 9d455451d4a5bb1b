"""The exercises of lesson 03, convolution by hand."""

from collections.abc import Callable

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.checks import states
from numpy_cae.course.exercises.exercise import exercise, operation_exercise
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import OPERATIONS, definitions
from numpy_cae.verify.operations.property import require_equal

CONV1D = OPERATIONS["conv1d"]


def conv1d_by_loops(x: np.ndarray, w: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The value of the package's convolution."""
    y, _ = ops.conv1d(x, w, b)
    return y


def unfold(x: np.ndarray, taps: int) -> np.ndarray:
    """Row t holds the frames that a filter reads at t, (B, T, K * C)."""
    batch, frames, _ = x.shape
    padded = np.pad(x, ((0, 0), (taps // 2, taps // 2), (0, 0)))
    windows = [padded[:, t : t + taps].reshape(batch, -1) for t in range(frames)]
    return np.stack(windows, axis=1)


def _unfold_arguments(case: Case) -> dict[str, object]:
    return {"x": CONV1D.arguments(case)["x"], "taps": case["taps"]}


@states("times a matrix", "the rows times w as one matrix, plus b, are the convolution")
def _times_matrix(function: Callable, case: Case) -> None:
    x, w, b = CONV1D.arguments(case).values()
    y = function(x.copy(), len(w)) @ w.reshape(-1, w.shape[-1]) + b
    require_equal("unfold(x, K) @ w.reshape(K * C, D) + b", y, definitions.conv1d(x, w, b))


@states("dtype", "float32 stays float32")
def _keeps_float32(function: Callable, case: Case) -> None:
    x, taps = _unfold_arguments(case).values()
    found = np.asarray(function(x.astype(np.float32), taps)).dtype
    if found != np.float32:
        raise AssertionError(f"given float32, the rows are {found}")


EXERCISES = (
    exercise(
        conv1d_by_loops,
        CONV1D.arguments,
        CONV1D.sizes,
        value="y[t] = Σ_k x[t + k - K//2] w[k] + b, zeros beyond both ends",
        definition=definitions.conv1d,
        points=3,
    ),
    exercise(
        unfold,
        _unfold_arguments,
        {name: CONV1D.sizes[name] for name in ("batch", "frames", "channels", "filters", "taps")},
        _times_matrix,
        _keeps_float32,
        value="row t holds x[t - K//2], ..., x[t + K//2], frame after frame",
    ),
    operation_exercise("transpose_filters"),
    operation_exercise("conv1d"),
)
