"""TensorFlow: cumprod."""

import numpy as np

from studies.gradients.published import PublishedOperation


def cumprod(x, *, fixed):
    y = np.cumprod(x)

    def pullback(dy):
        if fixed:
            dx = np.zeros_like(x)
            for i in range(len(x)):
                others = np.where(np.arange(len(x)) == i, 1, x).astype(x.dtype)
                dx[i] = (np.cumprod(others) * dy)[i:].sum()
            return dx
        else:
            out = np.cumsum((y * dy)[::-1])[::-1]
            return np.divide(out, x, out=np.zeros_like(x), where=x != 0)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="TensorFlow",
    operation="cumprod",
    thread="https://github.com/tensorflow/tensorflow/issues/119430",
    fix="https://github.com/tensorflow/tensorflow/pull/120282",
    mistake="The gradient divides by x, and 0 / 0 is replaced by 0.",
    shapes={"x": "frames"},
    function=cumprod,
)
