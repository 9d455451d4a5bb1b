"""PyTensor (MLX backend): advanced indexing."""

import numpy as np

from studies.gradients.published import PublishedOperation


def take(x, *, fixed):
    places = np.arange(2 * len(x)) // 2

    def pullback(dy):
        dx = np.zeros_like(x)
        if fixed:
            np.add.at(dx, places, dy)
        else:
            dx[places] += dy
        return dx

    return x[places], pullback


PUBLISHED = PublishedOperation(
    project="PyTensor (MLX backend)",
    operation="advanced indexing",
    thread="https://github.com/pymc-devs/pytensor/pull/2242",
    fix="https://github.com/pymc-devs/pytensor/pull/2242",
    mistake=(
        "x[places] += y writes a row that occurs twice once: its gradient is that of one "
        "occurrence."
    ),
    shapes={"x": "frames channels"},
    function=take,
)
