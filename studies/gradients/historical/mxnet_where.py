"""MXNet: np.where with a number."""

import numpy as np

from studies.gradients.published import PublishedOperation


def where(x, *, fixed):
    chosen = np.arange(x.size).reshape(x.shape) % 2 == 0

    def pullback(dy):
        if fixed:
            return np.where(chosen, dy, 0)
        else:
            return np.where(chosen, 0, dy)

    return np.where(chosen, x, -1).astype(x.dtype), pullback


PUBLISHED = PublishedOperation(
    project="MXNet",
    operation="np.where with a number",
    thread="https://github.com/apache/mxnet/issues/17893",
    fix="https://github.com/apache/incubator-mxnet/pull/17899",
    mistake=(
        "With a number in the third place, the gradient for the second is selected by the "
        "opposite of the condition."
    ),
    shapes={"x": "batch channels"},
    function=where,
)
