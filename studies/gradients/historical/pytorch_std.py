"""PyTorch: std."""

import numpy as np

from studies.gradients.published import PublishedOperation


def std(x, *, fixed):
    d = x - x.mean(axis=-1, keepdims=True)
    y = np.sqrt((d * d).mean(axis=-1))

    def pullback(dy):
        if fixed:
            return dy[:, None] * d / (np.where(y == 0, 1, y).astype(x.dtype)[:, None] * x.shape[-1])
        else:
            return dy[:, None] * d / (y[:, None] * x.shape[-1])

    return y, pullback


PUBLISHED = PublishedOperation(
    project="PyTorch",
    operation="std",
    thread="https://github.com/pytorch/pytorch/issues/4320",
    fix="https://github.com/pytorch/pytorch/pull/9238",
    mistake="The gradient is (x - mean) / std: nan where all numbers are equal.",
    shapes={"x": "batch channels"},
    function=std,
)
