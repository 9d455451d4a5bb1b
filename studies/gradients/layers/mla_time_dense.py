"""MLAlgorithms: dense layer of sequences."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dense(x, w, b):
    rows = x.reshape(-1, x.shape[-1])

    def pullback(dy):
        d = dy.reshape(-1, dy.shape[-1])
        return (d @ w.T).reshape(-1, dy.shape[1], x.shape[-1]), rows.T @ d, np.sum(d, axis=0)

    return (rows @ w + b).reshape(-1, x.shape[1], w.shape[1]), pullback


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="dense layer of sequences",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/basic.py",
    shapes={"x": "batch frames channels", "w": "channels features", "b": "features"},
    function=dense,
)
