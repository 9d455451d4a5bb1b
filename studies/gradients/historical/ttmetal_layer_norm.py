"""tt-metal: layer norm."""

import numpy as np

from studies.gradients.published import PublishedOperation


def layer_norm(x, *, fixed):
    d = x - x.mean(axis=-1, keepdims=True)
    scale = 1 / np.sqrt((d * d).mean(axis=-1, keepdims=True) + 1e-3)
    y = d * scale

    def pullback(dy):
        mean = dy.mean(axis=-1, keepdims=True)
        if not fixed:
            mean = mean + mean
        return scale * (dy - mean - y * (dy * y).mean(axis=-1, keepdims=True))

    return y, pullback


PUBLISHED = PublishedOperation(
    project="tt-metal",
    operation="layer norm",
    thread="https://github.com/tenstorrent/tt-metal/pull/53215",
    fix="https://github.com/tenstorrent/tt-metal/pull/53215",
    mistake=(
        "A register is not cleared: the mean of the upstream gradient is subtracted twice. "
        "The test allowed an error of 0.5."
    ),
    shapes={"x": "batch channels"},
    function=layer_norm,
)
