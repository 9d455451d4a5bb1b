"""Torch 7: nn.Mean."""

import numpy as np

from studies.gradients.published import PublishedOperation, in_memory_order


def mean(x, *, fixed):
    def pullback(dy):
        if not fixed:
            dy = in_memory_order(dy)
        return np.repeat(dy[..., None] / x.shape[-1], x.shape[-1], axis=-1)

    return x.mean(axis=-1), pullback


PUBLISHED = PublishedOperation(
    project="Torch 7",
    operation="nn.Mean",
    thread="https://github.com/torch/nn/pull/345",
    fix="https://github.com/torch/nn/pull/345",
    mistake=(
        "The upstream gradient is taken for contiguous, which that of a second nn.Mean is not."
    ),
    shapes={"x": "batch frames channels"},
    function=mean,
)
