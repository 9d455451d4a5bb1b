"""PyTorch: index_fill."""

import numpy as np

from studies.gradients.published import PublishedOperation


def index_fill(x, v, *, fixed):
    rows = np.array([0, 0]) % len(x)
    y = x.copy()
    y[rows] = v

    def pullback(dy):
        dx = dy.copy()
        dx[rows] = 0
        if fixed:
            return dx, dy[np.unique(rows)].sum(axis=0)
        else:
            return dx, dy[rows].sum(axis=0)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="PyTorch",
    operation="index_fill",
    thread="https://github.com/pytorch/pytorch/issues/57006",
    fix="https://github.com/pytorch/pytorch/pull/57101",
    mistake="A row that is filled twice counts twice in the gradient for the filling number.",
    shapes={"x": "frames channels", "v": "channels"},
    function=index_fill,
)
