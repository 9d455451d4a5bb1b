"""Knet: batch norm with a scale."""

import numpy as np

from studies.gradients.published import PublishedOperation


def batch_norm(x, g, *, fixed):
    d = x - x.mean(axis=0)
    scale = 1 / np.sqrt((d * d).mean(axis=0) + 1e-3)
    y = d * scale

    def pullback(dy):
        if fixed:
            dunit = g * dy
        else:
            dunit = dy
        dx = scale * (dunit - dunit.mean(axis=0) - y * (dunit * y).mean(axis=0))
        return dx, (dy * y).sum(axis=0)

    return g * y, pullback


PUBLISHED = PublishedOperation(
    project="Knet",
    operation="batch norm with a scale",
    thread="https://github.com/denizyuret/Knet.jl/issues/288",
    fix="https://github.com/denizyuret/Knet.jl/pull/289",
    mistake="The scale is missing in the gradient for x. The test used scales of 1.",
    shapes={"x": "batch channels", "g": "channels"},
    function=batch_norm,
)
