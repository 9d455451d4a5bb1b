"""TensorFlow: reduce_prod."""

import numpy as np

from studies.gradients.published import PublishedOperation


def reduce_prod(x, *, fixed):
    y = x.prod(axis=-1)

    def pullback(dy):
        if fixed:
            ones = np.ones_like(x[:, :1])
            before = np.cumprod(np.hstack([ones, x[:, :-1]]), axis=1)
            behind = np.cumprod(np.hstack([ones, x[:, :0:-1]]), axis=1)[:, ::-1]
            return dy[:, None] * before * behind
        else:
            return dy[:, None] * y[:, None] / x

    return y, pullback


PUBLISHED = PublishedOperation(
    project="TensorFlow",
    operation="reduce_prod",
    thread="https://github.com/tensorflow/tensorflow/issues/2641",
    fix="https://github.com/tensorflow/tensorflow/pull/3351",
    mistake="The gradient is y / x: nan where x is 0.",
    shapes={"x": "batch channels"},
    function=reduce_prod,
)
