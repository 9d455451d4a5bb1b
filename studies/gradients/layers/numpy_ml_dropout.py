"""numpy-ml: dropout."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dropout(x, *, fixed):
    mask = (np.arange(x.size).reshape(x.shape) % 2).astype(x.dtype)

    def pullback(dy):
        if fixed:
            return dy * mask * 2
        else:
            dy *= 2.0
            return dy

    return x * mask * 2, pullback


PUBLISHED = PublishedOperation(
    project="numpy-ml",
    operation="dropout",
    thread="https://github.com/ddbourgin/numpy-ml/blob/master/numpy_ml/neural_nets/wrappers/wrappers.py",
    mistake="The pullback divides the upstream gradient in place, and does not apply the mask.",
    shapes={"x": "batch features"},
    function=dropout,
)
