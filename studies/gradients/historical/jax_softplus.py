"""JAX: softplus."""

import numpy as np

from studies.gradients.published import PublishedOperation


def softplus(x, *, fixed):
    y = np.maximum(x, 0) + np.log1p(np.exp(-np.abs(x)))

    def pullback(dy):
        e = np.exp(-np.abs(x))
        if fixed:
            return dy * np.where(x >= 0, 1, e) / (1 + e)
        else:
            return dy * ((x > 0) - np.sign(x) * e / (1 + e))

    return y, pullback


PUBLISHED = PublishedOperation(
    project="JAX",
    operation="softplus",
    thread="https://github.com/jax-ml/jax/issues/2107",
    fix="https://github.com/jax-ml/jax/pull/2356",
    mistake=(
        "It is differentiated as max(x, 0) + log(1 + exp(-|x|)): the gradient at 0 is 0 "
        "instead of 1/2."
    ),
    shapes={"x": "batch channels"},
    function=softplus,
)
