"""cTensor: mean along an axis."""

import numpy as np

from studies.gradients.published import PublishedOperation


def mean(x, *, fixed):
    y = x.mean(axis=-1)

    def pullback(dy):
        if fixed:
            count = x.shape[-1]
        else:
            count = y.size
        return np.repeat(dy[:, None] / count, x.shape[-1], axis=1)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="cTensor",
    operation="mean along an axis",
    thread="https://github.com/pocketpy/cTensor/pull/24",
    fix="https://github.com/pocketpy/cTensor/pull/24",
    mistake=(
        "The gradient is divided by the number of means instead of the number of entries of each."
    ),
    shapes={"x": "batch channels"},
    function=mean,
)
