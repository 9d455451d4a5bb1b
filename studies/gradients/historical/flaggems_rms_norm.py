"""FlagGems: rms_norm."""

import numpy as np

from studies.gradients.published import PublishedOperation, in_memory_order


def rms_norm(x, *, fixed):
    scale = 1 / np.sqrt((x * x).mean(axis=-1, keepdims=True) + 1e-3)
    y = x * scale

    def pullback(dy):
        if not fixed:
            dy = in_memory_order(dy)
        return scale * (dy - y * (dy * y).mean(axis=-1, keepdims=True))

    return y, pullback


PUBLISHED = PublishedOperation(
    project="FlagGems",
    operation="rms_norm",
    thread="https://github.com/flagos-ai/FlagGems/pull/1084",
    fix="https://github.com/flagos-ai/FlagGems/pull/1084",
    mistake="The kernel reads the upstream gradient as if its rows followed each other in memory.",
    shapes={"x": "batch channels"},
    function=rms_norm,
)
