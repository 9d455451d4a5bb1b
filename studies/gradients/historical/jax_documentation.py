"""JAX: custom_vjp, the example of the documentation."""

import numpy as np

from studies.gradients.published import PublishedOperation


def f(x, y, *, fixed):
    def pullback(dz):
        if fixed:
            return np.cos(x) * dz * y, np.sin(x) * dz
        else:
            return np.cos(x) * dz * y, -np.sin(x) * dz

    return np.sin(x) * y, pullback


PUBLISHED = PublishedOperation(
    project="JAX",
    operation="custom_vjp, the example of the documentation",
    thread="https://github.com/jax-ml/jax/issues/3213",
    fix="https://github.com/jax-ml/jax/issues/3213",
    mistake="The derivative of sin(x) · y for y is written as -sin(x).",
    shapes={"x": "batch", "y": "batch"},
    function=f,
)
