"""TVM: tanh."""

import numpy as np

from studies.gradients.published import PublishedOperation


def tanh(x, *, fixed):
    y = np.tanh(x)

    def pullback(dy):
        if fixed:
            return dy * (np.ones_like(y) - y * y)
        else:
            return dy * np.ones_like(y) - y * y

    return y, pullback


PUBLISHED = PublishedOperation(
    project="TVM",
    operation="tanh",
    thread="https://github.com/apache/tvm/pull/7340",
    fix="https://github.com/apache/tvm/pull/7340",
    mistake="A pair of parentheses is missing: dy · 1 - y² instead of dy · (1 - y²).",
    shapes={"x": "batch channels"},
    function=tanh,
)
