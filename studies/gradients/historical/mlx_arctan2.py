"""MLX: arctan2."""

import numpy as np

from studies.gradients.published import PublishedOperation


def arctan2(y, x, *, fixed):
    r = x * x + y * y

    def pullback(dz):
        if fixed:
            return dz * x / r, -dz * y / r
        else:
            return dz * y / r, -dz * y / r

    return np.arctan2(y, x), pullback


PUBLISHED = PublishedOperation(
    project="MLX",
    operation="arctan2",
    thread="https://github.com/ml-explore/mlx/issues/2451",
    fix="https://github.com/ml-explore/mlx/pull/2453",
    mistake=(
        "The gradient for the first argument has the first argument as its numerator instead "
        "of the second."
    ),
    shapes={"y": "batch channels", "x": "batch channels"},
    ranges={"x": (0.5, 3.0)},
    function=arctan2,
)
