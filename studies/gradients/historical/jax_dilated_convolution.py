"""JAX: conv_general_dilated."""

import numpy as np

from studies.gradients.published import PublishedOperation


def dilated(x, w, dilation=2, *, fixed):
    frames = len(x)
    y = np.zeros_like(x)
    for k in range(min(len(w), -(-frames // dilation))):
        y[k * dilation :] += x[: frames - k * dilation] * w[k]

    def pullback(dy):
        dx, dw = np.zeros_like(x), np.zeros_like(w)
        for k in range(min(len(w), -(-frames // dilation))):
            dw[k] = (dy[k * dilation :] * x[: frames - k * dilation]).sum(axis=0)
            if fixed:
                dx[: frames - k * dilation] += dy[k * dilation :] * w[k]
            else:
                dx[: frames - k] += dy[k:] * w[k]
        return dx, dw

    return y, pullback


PUBLISHED = PublishedOperation(
    project="JAX",
    operation="conv_general_dilated",
    thread="https://github.com/jax-ml/jax/pull/567",
    fix="https://github.com/jax-ml/jax/pull/567",
    mistake="The dilation of the filter is forgotten in the gradient for the input.",
    shapes={"x": "frames channels", "w": "taps channels"},
    function=dilated,
)
