"""Deep Learning from Scratch 2: sigmoid with cross entropy of sequences."""

import numpy as np

from studies.gradients.published import PublishedOperation


def loss(x):
    y = 1 / (1 + np.exp(-x))
    labels = np.arange(x.size).reshape(x.shape) % 2
    right = np.where(labels == 1, y, 1 - y)
    value = sum(-np.mean(np.log(right[:, t])) for t in range(x.shape[1])) / x.shape[1]

    def pullback(dloss=1.0):
        dx = np.empty(x.shape, "f")
        for t in range(x.shape[1]):
            dx[:, t] = (y[:, t] - labels[:, t]) * dloss / x.shape[1] / len(x)
        return dx

    return value, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="sigmoid with cross entropy of sequences",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={"x": "batch frames"},
    dtypes=("float32",),
    function=loss,
)
