"""tinynn: softmax cross entropy with a temperature."""

import numpy as np

from studies.gradients.published import PublishedOperation


def cross_entropy(x, *, fixed):
    temperature = 2.0
    z = x / temperature
    e = np.exp(z - z.max(axis=1, keepdims=True))
    p = e / e.sum(axis=1, keepdims=True)
    first = np.zeros_like(x)
    first[:, 0] = 1

    def pullback(dloss):
        if fixed:
            return (dloss * (p - first) / temperature / len(x)).astype(x.dtype)
        else:
            return (dloss * (p - first) / len(x)).astype(x.dtype)

    return -np.mean(np.log(p[:, 0])), pullback


PUBLISHED = PublishedOperation(
    project="tinynn",
    operation="softmax cross entropy with a temperature",
    thread="https://github.com/borgwang/tinynn/blob/master/tinynn/core/loss.py",
    mistake="The factor 1/T is missing.",
    shapes={"x": "batch classes"},
    function=cross_entropy,
)
