"""MXNet: bidirectional LSTM, here a linear recurrence."""

import numpy as np

from studies.gradients.published import PublishedOperation


def both_directions(x, *, fixed):
    y = np.cumsum(x, axis=0) + np.cumsum(x[::-1], axis=0)[::-1]

    def pullback(dy):
        if fixed:
            dx = dy.copy()
        else:
            dx = dy
        dx[...] = np.cumsum(dy[::-1].copy(), axis=0)[::-1]
        return dx + np.cumsum(dy, axis=0)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="MXNet",
    operation="bidirectional LSTM, here a linear recurrence",
    thread="https://github.com/apache/mxnet/pull/18203",
    fix="https://github.com/apache/mxnet/pull/18203",
    mistake=(
        "The gradient for the input is written over the upstream gradient before the "
        "direction from right to left has read it."
    ),
    shapes={"x": "frames channels"},
    function=both_directions,
)
