"""Deep Learning from Scratch 2: softmax with cross entropy of sequences."""

import numpy as np

from studies.gradients.published import PublishedOperation


def loss(x, *, fixed):
    rows = x.reshape(-1, x.shape[2])
    y = np.exp(rows - rows.max(axis=1, keepdims=True))
    y /= y.sum(axis=1, keepdims=True)
    every, labels = np.arange(len(rows)), np.arange(len(rows)) % x.shape[2]
    counted = np.arange(len(rows)) % 3 != 1
    value = -np.sum(np.log(y[every, labels]) * counted) / counted.sum()

    def pullback(dloss=1.0):
        if fixed:
            dx = y.copy()
        else:
            dx = y
        dx[every, labels] -= 1
        dx *= dloss
        dx /= counted.sum()
        dx *= counted[:, None]
        return dx.reshape(x.shape)

    return value, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="softmax with cross entropy of sequences",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    mistake=(
        "The pullback changes the probabilities that it keeps, so that a second call is wrong."
    ),
    shapes={"x": "batch frames classes"},
    function=loss,
)
