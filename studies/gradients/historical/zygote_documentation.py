"""Zygote: @adjoint, the example of the documentation."""

import numpy as np

from studies.gradients.published import PublishedOperation


def sine(x, *, fixed):
    def pullback(dy):
        if fixed:
            return dy * np.cos(x)
        else:
            return dy * np.sin(x)

    return np.sin(x), pullback


PUBLISHED = PublishedOperation(
    project="Zygote",
    operation="@adjoint, the example of the documentation",
    thread="https://github.com/FluxML/Zygote.jl/pull/1176",
    fix="https://github.com/FluxML/Zygote.jl/pull/1176",
    mistake="The derivative of the sine is written as the sine.",
    shapes={"x": "batch"},
    function=sine,
)
