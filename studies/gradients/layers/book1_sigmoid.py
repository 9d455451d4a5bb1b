"""Deep Learning from Scratch: sigmoid."""

import numpy as np

from studies.gradients.published import PublishedOperation


def sigmoid(x):
    y = 1 / (1 + np.exp(-x))
    return y, lambda dy: dy * y * (1.0 - y)


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch",
    operation="sigmoid",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch/blob/master/common/layers.py",
    shapes={"x": "batch features"},
    function=sigmoid,
)
