"""TinyTorch: matrix times vector."""

import numpy as np

from studies.gradients.published import PublishedOperation


def matmul(a, b, *, fixed):
    def pullback(dy):
        if fixed:
            return np.outer(dy, b), a.T @ dy
        else:
            return np.zeros_like(a) + np.matmul(dy, b.T), a.T @ dy

    return a @ b, pullback


PUBLISHED = PublishedOperation(
    project="TinyTorch",
    operation="matrix times vector",
    thread="https://github.com/harvard-edge/cs249r_book/pull/1781",
    fix="https://github.com/harvard-edge/cs249r_book/pull/1781",
    mistake=(
        "b.T of a vector is b: the product with the upstream gradient is a number, not the "
        "outer product."
    ),
    shapes={"a": "channels channels", "b": "channels"},
    function=matmul,
)
