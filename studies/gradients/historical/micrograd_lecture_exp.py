"""micrograd (lecture): Value.exp."""

import numpy as np

from studies.gradients.published import PublishedOperation


def x_times_exp(x, *, fixed):
    e = np.exp(x)

    def pullback(dy):
        dx = np.zeros_like(x)
        dx += dy * e
        if fixed:
            dx += dy * x * e
        else:
            dx = dy * x * e
        return dx

    return x * e, pullback


PUBLISHED = PublishedOperation(
    project="micrograd (lecture)",
    operation="Value.exp",
    thread="https://github.com/karpathy/nn-zero-to-hero/issues/52",
    fix="https://github.com/karpathy/nn-zero-to-hero/issues/52",
    mistake=(
        "The gradient is assigned, = instead of +=, and overwrites that of the other use of x."
    ),
    shapes={"x": "batch channels"},
    function=x_times_exp,
)
