"""MLAlgorithms: dropout."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dropout(x):
    kept = np.random.default_rng(x.size).uniform(size=x.shape) > 0.1
    return x * kept, lambda dy: dy * kept


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="dropout",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/basic.py",
    shapes={"x": "batch features"},
    function=dropout,
)
