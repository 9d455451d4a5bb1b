"""Deep Learning from Scratch 2: sigmoid with cross entropy."""

import numpy as np

from studies.gradients.published import PublishedOperation


def loss(x):
    y = 1 / (1 + np.exp(-x))
    labels = np.arange(len(x)) % 2
    right = np.where(labels == 1, y, 1 - y)
    return -np.mean(np.log(right)), lambda dloss=1.0: (y - labels) * dloss / len(x)


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="sigmoid with cross entropy",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/layers.py",
    shapes={"x": "batch"},
    function=loss,
)
