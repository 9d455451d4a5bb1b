"""Deep Learning from Scratch 2: dropout of sequences."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dropout(x):
    kept = np.random.default_rng(x.size).random(x.shape) > 0.5
    mask = kept.astype(np.float32) * 2
    return x * mask, lambda dy: dy * mask


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="dropout of sequences",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={"x": "batch frames channels"},
    function=dropout,
)
