"""Deep Learning from Scratch 2: matrix product."""

import numpy as np

from studies.gradients.published import PublishedOperation


def matmul(x, w):
    dw = np.zeros_like(w)

    def pullback(dy):
        dw[...] = x.T @ dy
        return dy @ w.T, dw.copy()

    return x @ w, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="matrix product",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/layers.py",
    shapes={"x": "batch features", "w": "features units"},
    function=matmul,
)
