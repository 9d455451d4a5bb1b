"""QuACK: RMS norm of a residual stream."""

import numpy as np

from studies.gradients.published import PublishedOperation


def prenorm(x, *, fixed):
    scale = 1 / np.sqrt((x * x).mean(axis=-1, keepdims=True) + 1e-3)
    y = x * scale

    def pullback(dz):
        of_residual, of_norm = np.split(dz, 2, axis=-1)
        if not fixed:
            of_norm, of_residual = of_norm + of_residual, 0
        dx = scale * (of_norm - y * (of_norm * y).mean(axis=-1, keepdims=True))
        return of_residual + dx

    return np.concatenate([x, y], axis=-1), pullback


PUBLISHED = PublishedOperation(
    project="QuACK",
    operation="RMS norm of a residual stream",
    thread="https://github.com/Dao-AILab/quack/pull/53",
    fix="https://github.com/Dao-AILab/quack/pull/53",
    mistake=(
        "The gradient of the residual output is added before the derivative of the norm "
        "instead of after it."
    ),
    shapes={"x": "batch channels"},
    function=prenorm,
)
