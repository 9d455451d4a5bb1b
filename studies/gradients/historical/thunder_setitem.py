"""Lightning Thunder: x[index] = value."""

import numpy as np

from studies.gradients.published import PublishedOperation


def assign(x, v, *, fixed):
    value = v[:, None]
    y = x.copy()
    y[...] = value

    def pullback(dy):
        if fixed:
            return np.zeros_like(x), dy.sum(axis=1)
        else:
            return np.zeros_like(x), dy[:, 0].copy()

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Lightning Thunder",
    operation="x[index] = value",
    thread="https://github.com/Lightning-AI/lightning-thunder/pull/1979",
    fix="https://github.com/Lightning-AI/lightning-thunder/pull/1979",
    mistake=(
        "A value that is broadcast along an axis of size 1 gets a gradient that is not summed"
        " along it."
    ),
    shapes={"x": "batch channels", "v": "batch"},
    function=assign,
)
