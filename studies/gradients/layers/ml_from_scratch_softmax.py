"""ML-From-Scratch: softmax."""

import numpy as np

from studies.gradients.published import PublishedOperation


def softmax(x, *, fixed):
    e = np.exp(x - x.max(axis=1, keepdims=True))
    p = e / e.sum(axis=1, keepdims=True)

    def pullback(dy):
        if fixed:
            return p * (dy - np.sum(dy * p, axis=1, keepdims=True))
        else:
            return dy * p * (1 - p)

    return p, pullback


PUBLISHED = PublishedOperation(
    project="ML-From-Scratch",
    operation="softmax",
    thread="https://github.com/eriklindernoren/ML-From-Scratch/blob/master/mlfromscratch/deep_learning/activation_functions.py",
    mistake="The derivative is the diagonal of the Jacobian only.",
    shapes={"x": "batch classes"},
    function=softmax,
)
