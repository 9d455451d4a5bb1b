"""tinynn: max pooling."""

import numpy as np

from studies.gradients.published import PublishedOperation


def max_pool(x, *, fixed):
    pairs = x.reshape(len(x), -1, 2, x.shape[2])
    winner = pairs.argmax(axis=2)[:, :, None]
    y = np.empty((len(x), pairs.shape[1], x.shape[2]), x.dtype)
    for t in range(pairs.shape[1]):
        kept = np.take_along_axis(pairs[:, t], winner[:, t], axis=1)
        if fixed:
            y[:, t] = kept[:, 0]
        else:
            y[:, t] = kept.squeeze()

    def pullback(dy):
        dx = np.zeros_like(pairs)
        np.put_along_axis(dx, winner, dy[:, :, None], axis=2)
        return dx.reshape(x.shape)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="tinynn",
    operation="max pooling",
    thread="https://github.com/borgwang/tinynn/blob/master/tinynn/core/layer.py",
    mistake="An axis of length one is squeezed away, so that one channel crashes.",
    shapes={"x": "batch 2*frames channels"},
    function=max_pool,
)
