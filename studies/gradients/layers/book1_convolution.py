"""Deep Learning from Scratch: convolution by columns."""

import numpy as np

from studies.gradients.published import PublishedOperation


def convolution(x, w, b):
    columns = np.stack([x[..., :2], x[..., 1:3], x[..., 2:]], axis=-1)
    flat = columns.transpose(0, 2, 3, 1, 4).reshape(-1, w[0].size)
    y = (flat @ w.reshape(len(w), -1).T + b).reshape(len(x), x.shape[2], 2, -1)

    def pullback(dy):
        dy = dy.transpose(0, 2, 3, 1).reshape(-1, len(w))
        dw = (flat.T @ dy).T.reshape(w.shape)
        d = (dy @ w.reshape(len(w), -1)).reshape(len(x), x.shape[2], 2, x.shape[1], 3)
        dx = np.zeros(x.shape, d.dtype)
        for tap in range(3):
            dx[..., tap : tap + 2] += d[..., tap].transpose(0, 3, 1, 2)
        return dx, dw, dy.sum(axis=0)

    return y.transpose(0, 3, 1, 2), pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch",
    operation="convolution by columns",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch/blob/master/common/layers.py",
    shapes={"x": "batch channels rows 4", "w": "filters channels 1 3", "b": "filters"},
    function=convolution,
)
