"""Nx and Axon (Elixir): the gradient of a while loop."""

import numpy as np

from studies.gradients.published import PublishedOperation


def power_by_loop(x, steps=3, *, fixed):
    accumulators = [np.ones_like(x)]
    for _ in range(steps):
        accumulators.append(accumulators[-1] * x)

    def pullback(dy):
        dx, carried = np.zeros_like(x), dy
        for k in range(steps):
            if fixed:
                dx += carried * accumulators[steps - 1 - k]
            else:
                dx += carried * accumulators[k]
            carried = carried * x
        return dx

    return accumulators[-1], pullback


PUBLISHED = PublishedOperation(
    project="Nx and Axon (Elixir)",
    operation="the gradient of a while loop",
    thread="https://github.com/elixir-nx/nx/issues/1747",
    fix="https://github.com/elixir-nx/nx/pull/1785",
    mistake=(
        "The factors of the steps are combined in the order of the forward pass, as if they "
        "commuted in time."
    ),
    shapes={"x": "batch channels"},
    function=power_by_loop,
)
