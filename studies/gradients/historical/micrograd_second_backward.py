"""micrograd: Value.backward."""

import numpy as np

from studies.gradients.published import PublishedOperation


def cubed(x, *, fixed):
    inner = np.zeros_like(x)

    def pullback(dy):
        if fixed:
            inner[...] = 0
        inner[...] += 3 * dy
        return inner * x * x

    return x * x * x, pullback


PUBLISHED = PublishedOperation(
    project="micrograd",
    operation="Value.backward",
    thread="https://github.com/karpathy/micrograd/pull/102",
    fix="https://github.com/karpathy/micrograd/pull/102",
    mistake="The gradients of inner nodes are kept: a second backward adds to those of the first.",
    shapes={"x": "batch channels"},
    function=cubed,
)
