"""tinygrad: sigmoid."""

import numpy as np

from studies.gradients.published import PublishedOperation


def sigmoid(x, *, fixed):
    with np.errstate(over="ignore", invalid="ignore"):
        e = np.exp(-x)
        y = 1 / (1 + e)

    def pullback(dy):
        if fixed:
            return dy * y * (1 - y)
        else:
            return dy * (y * y) * e

    return y, pullback


PUBLISHED = PublishedOperation(
    project="tinygrad",
    operation="sigmoid",
    thread="https://github.com/tinygrad/tinygrad/pull/1113",
    fix="https://github.com/tinygrad/tinygrad/pull/1113",
    mistake=(
        "It is differentiated as 1 / (1 + exp(-x)): for large negative x the gradient is 0 · "
        "inf, nan."
    ),
    shapes={"x": "batch channels"},
    ranges={"x": (-1000.0, 1000.0)},
    function=sigmoid,
)
