"""Darknet: softmax layer."""

import numpy as np

from studies.gradients.published import PublishedOperation


def softmax(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    y = e / e.sum(axis=-1, keepdims=True)

    def pullback(dy):
        if fixed:
            return y * (dy - (dy * y).sum(axis=-1, keepdims=True))
        else:
            return dy.copy()

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Darknet",
    operation="softmax layer",
    thread="https://github.com/pjreddie/darknet/pull/96",
    fix="https://github.com/pjreddie/darknet/pull/96",
    mistake="The upstream gradient is copied: the derivative of softmax itself is missing.",
    shapes={"x": "batch classes"},
    function=softmax,
)
