"""Liger-Kernel: RMSNorm of Gemma 2."""

import numpy as np

from studies.gradients.published import PublishedOperation


def rms_norm(x, *, fixed):
    scale = 1 / np.sqrt((x * x).mean(axis=-1, keepdims=True) + 1e-3)
    y = x * scale

    def pullback(dy):
        dx = scale * (dy - y * (dy * y).mean(axis=-1, keepdims=True))
        if fixed:
            return dx
        else:
            dy[...] = dx
            return dy

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Liger-Kernel",
    operation="RMSNorm of Gemma 2",
    thread="https://github.com/linkedin/Liger-Kernel/pull/376",
    fix="https://github.com/linkedin/Liger-Kernel/pull/376",
    mistake=(
        "The pullback writes its result into the upstream gradient, which the residual path "
        "still needs."
    ),
    shapes={"x": "batch channels"},
    function=rms_norm,
)
