"""DeepSpeed: layer norm that recomputes its input."""

import numpy as np

from studies.gradients.published import PublishedOperation


def normalised_and_shifted(x, shift, *, fixed):
    d = x - x.mean(axis=-1, keepdims=True)
    scale = 1 / np.sqrt((d * d).mean(axis=-1, keepdims=True) + 1e-3)
    y = d * scale + shift

    def pullback(dy):
        if fixed:
            unit = y - shift
        else:
            unit = y - shift[np.arange(len(x)) % len(shift)][:, None]
        mean = dy.mean(axis=-1, keepdims=True)
        dx = scale * (dy - mean - unit * (dy * unit).mean(axis=-1, keepdims=True))
        return dx, dy.sum(axis=0)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="DeepSpeed",
    operation="layer norm that recomputes its input",
    thread="https://github.com/deepspeedai/DeepSpeed/pull/692",
    fix="https://github.com/deepspeedai/DeepSpeed/pull/692",
    mistake=(
        "The normalised input is recomputed as (y - β) / γ with the index of the row in place"
        " of the column."
    ),
    shapes={"x": "batch channels", "shift": "channels"},
    function=normalised_and_shifted,
)
