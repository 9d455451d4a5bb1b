"""TensorFlow: tf.norm."""

import numpy as np

from studies.gradients.published import PublishedOperation


def norm(x, *, fixed):
    y = np.sqrt((x * x).sum(axis=-1))

    def pullback(dy):
        if fixed:
            return dy[:, None] * x / np.where(y == 0, 1, y).astype(x.dtype)[:, None]
        else:
            return dy[:, None] * x / y[:, None]

    return y, pullback


PUBLISHED = PublishedOperation(
    project="TensorFlow",
    operation="tf.norm",
    thread="https://github.com/tensorflow/tensorflow/issues/12071",
    fix="https://github.com/tensorflow/tensorflow/pull/112634",
    mistake="The gradient is x / |x|: nan at x = 0, where 0 is a subgradient.",
    shapes={"x": "batch channels"},
    function=norm,
)
