"""tinynn: dense layer."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dense(x, w, b):
    grads = {}

    def pullback(dy):
        grads["w"] = x.T @ dy
        grads["b"] = np.sum(dy, axis=0)
        return dy @ w.T, grads["w"], grads["b"]

    return x @ w + b, pullback


PUBLISHED = PublishedOperation(
    project="tinynn",
    operation="dense layer",
    thread="https://github.com/borgwang/tinynn/blob/master/tinynn/core/layer.py",
    shapes={"x": "batch features", "w": "features units", "b": "units"},
    function=dense,
)
