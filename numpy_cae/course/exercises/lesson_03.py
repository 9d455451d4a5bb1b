"""The exercises of lesson 03, convolution by hand."""

from __future__ import annotations

from collections.abc import Callable

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
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case
from numpy_cae.verify.operation import OPERATIONS
from numpy_cae.verify.property import require_equal

SIZES = OPERATIONS["conv1d"].sizes
_arguments = OPERATIONS["conv1d"].arguments


def conv1d_by_loops(x: np.ndarray, w: np.ndarray, b: np.ndarray) -> np.ndarray:
    y, _ = ops.conv1d(x, w, b)
    return y


def unfold(x: np.ndarray, taps: int) -> np.ndarray:
    batch, frames, _ = x.shape
    padded = np.pad(x, ((0, 0), (taps // 2, taps // 2), (0, 0)))
    windows = [padded[:, t : t + taps].reshape(batch, -1) for t in range(frames)]
    return np.stack(windows, axis=1)


def _window(case: Case) -> dict[str, object]:
    return {"x": _arguments(case)["x"], "taps": case["taps"]}


def _times_matrix(function: Callable, case: Case) -> None:
    x, w, b = _arguments(case).values()
    y = function(x.copy(), len(w)) @ w.reshape(-1, w.shape[-1]) + b
    require_equal("unfold(x, K) @ w.reshape(K * C, D) + b", y, definitions.conv1d(x, w, b))


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "conv1d_by_loops",
        "five loops: over windows, frames, filters, taps and channels; skip a tap that reads a "
        "frame which is not there",
        conv1d_by_loops,
        _arguments,
        SIZES,
        (
            Claim(
                "value",
                "y[t] = Σ_k x[t + k - K//2] w[k] + b, zeros beyond both ends",
                same_as(definitions.conv1d, _arguments),
                3,
                "a negative index does not fail in Python: it reads from the other end",
            ),
            unaltered(_arguments),
        ),
    ),
    exercise(
        "unfold",
        "pad both ends with K//2 frames of zeros, cut a window of K frames for every t, and lay "
        "each out as one row",
        unfold,
        _window,
        {name: SIZES[name] for name in ("batch", "frames", "channels", "filters", "taps")},
        (
            Claim(
                "value",
                "row t holds x[t - K//2], ..., x[t + K//2], frame after frame",
                same_as(unfold, _window, ("the rows",)),
                2,
            ),
            Claim(
                "times a matrix",
                "the rows times w as one matrix, plus b, are the convolution",
                _times_matrix,
            ),
            unaltered(_window),
        ),
    ),
    operation_exercise(
        "transpose_filters",
        "[::-1] turns an axis around, .transpose(0, 2, 1) exchanges two; what undoes both?",
    ),
    operation_exercise(
        "conv1d",
        "forward, one pass for every tap is enough: a slice of the padded x times w[k]. Backward, "
        "each gradient is a sum over the taps again; look at which frames met in the product",
        hints={
            "gradient for x": "frame s of x was read by y[t] wherever t + k - K//2 = s; solve for "
            "t, and call K - 1 - k by a new name",
            "gradient for w": "every window and every frame used the same w[k]: their gradients "
            "add up",
            "gradient for b": "b was added to every frame of every window",
        },
    ),
)
