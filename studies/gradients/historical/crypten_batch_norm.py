"""CrypTen: batch norm in training."""

import numpy as np

from studies.gradients.published import PublishedOperation


def batch_norm(x, *, fixed):
    d = x - x.mean(axis=0)
    scale = 1 / np.sqrt((d * d).mean(axis=0) + 1e-3)
    y = d * scale

    def pullback(dy):
        if fixed:
            return scale * (dy - dy.mean(axis=0) - y * (dy * y).mean(axis=0))
        else:
            return dy * scale

    return y, pullback


PUBLISHED = PublishedOperation(
    project="CrypTen",
    operation="batch norm in training",
    thread="https://github.com/facebookresearch/CrypTen/pull/143",
    fix="https://github.com/facebookresearch/CrypTen/pull/143",
    mistake="Mean and variance are taken for constants. The test did not switch training on.",
    shapes={"x": "batch channels"},
    function=batch_norm,
)
