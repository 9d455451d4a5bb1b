"""Nx (Elixir): clip."""

import numpy as np

from studies.gradients.published import PublishedOperation


def clip(x, *, fixed):
    inside = np.abs(x) < 1

    def pullback(dy):
        selected = np.where(inside, dy, 0)
        if fixed:
            return selected
        else:
            return selected * dy

    return np.clip(x, -1, 1), pullback


PUBLISHED = PublishedOperation(
    project="Nx (Elixir)",
    operation="clip",
    thread="https://github.com/elixir-nx/nx/pull/1779",
    fix="https://github.com/elixir-nx/nx/pull/1779",
    mistake=(
        "The upstream gradient is used twice, once in the mask and once as a factor: dy² "
        "instead of dy."
    ),
    shapes={"x": "batch channels"},
    function=clip,
)
