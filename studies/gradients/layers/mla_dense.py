"""MLAlgorithms: dense layer."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dense(x, w, b):
    return x @ w + b, lambda dy: (dy @ w.T, x.T @ dy, np.sum(dy, axis=0))


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="dense layer",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/basic.py",
    shapes={"x": "batch features", "w": "features units", "b": "units"},
    function=dense,
)
