"""Deep Learning from Scratch 2: softmax."""

import numpy as np

from studies.gradients.published import PublishedOperation


def softmax(x):
    y = np.exp(x - x.max(axis=1, keepdims=True))
    y /= y.sum(axis=1, keepdims=True)

    def pullback(dy):
        dx = y * dy
        dx -= y * dx.sum(axis=1, keepdims=True)
        return dx

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="softmax",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/layers.py",
    shapes={"x": "batch classes"},
    function=softmax,
)
