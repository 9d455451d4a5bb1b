"""Deep Learning from Scratch: dropout."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dropout(x):
    kept = np.random.default_rng(x.size).random(x.shape) > 0.5
    return x * kept, lambda dy: dy * kept


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch",
    operation="dropout",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch/blob/master/common/layers.py",
    shapes={"x": "batch features"},
    function=dropout,
)
