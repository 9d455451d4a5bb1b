"""tinynn: Huber loss."""

import numpy as np

from studies.gradients.published import PublishedOperation


def huber(x, y, *, fixed):
    error = x - y
    inside = np.abs(error) < 1
    loss = np.sum(np.where(inside, error**2 / 2, np.abs(error) - 0.5)) / len(x)

    def pullback(dloss):
        if fixed:
            d = np.where(inside, error, np.sign(error)) / len(x)
        else:
            d = np.where(inside, error, np.sign(error)) / len(x) / len(x)
        d = (dloss * d).astype(x.dtype)
        return d, -d

    return loss, pullback


PUBLISHED = PublishedOperation(
    project="tinynn",
    operation="Huber loss",
    thread="https://github.com/borgwang/tinynn/blob/master/tinynn/core/loss.py",
    mistake="The gradient is divided by the size of the batch twice.",
    shapes={"x": "batch features", "y": "batch features"},
    function=huber,
)
