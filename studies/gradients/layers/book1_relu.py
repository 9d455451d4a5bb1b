"""Deep Learning from Scratch: ReLU."""

import numpy as np

from studies.gradients.published import PublishedOperation


def relu(x, *, fixed):
    negative = x <= 0

    def pullback(dy):
        if fixed:
            return np.where(negative, 0, dy)
        else:
            dy[negative] = 0
            return dy

    return np.where(negative, 0, x), pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch",
    operation="ReLU",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch/blob/master/common/layers.py",
    mistake="The pullback sets entries of the upstream gradient to 0 in place.",
    shapes={"x": "batch features"},
    function=relu,
)
