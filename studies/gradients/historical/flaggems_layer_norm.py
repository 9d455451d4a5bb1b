"""FlagGems: layer_norm."""

import numpy as np

from studies.gradients.published import PublishedOperation


def layer_norm(x, *, fixed):
    d = x - x.mean(axis=-1, keepdims=True)
    scale = 1 / np.sqrt((d * d).mean(axis=-1, keepdims=True) + 1e-3)
    y = d * scale

    def pullback(dy):
        if fixed:
            axes = (2,)
        else:
            axes = (1, 2)
        centred = dy - dy.mean(axis=axes, keepdims=True)
        return scale * (centred - y * (dy * y).mean(axis=axes, keepdims=True))

    return y, pullback


PUBLISHED = PublishedOperation(
    project="FlagGems",
    operation="layer_norm",
    thread="https://github.com/flagos-ai/FlagGems/issues/5392",
    fix="https://github.com/flagos-ai/FlagGems/pull/5474",
    mistake=(
        "The backward step takes the first axis for the rows, whatever is normalised: wrong "
        "for three axes."
    ),
    shapes={"x": "batch frames channels"},
    function=layer_norm,
)
