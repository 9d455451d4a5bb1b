"""TransformerEngine: fused cross entropy."""

import numpy as np

from studies.gradients.published import PublishedOperation, in_memory_order


def cross_entropy(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    p = e / e.sum(axis=-1, keepdims=True)
    loss = np.log(e.sum(axis=-1)) + x.max(axis=-1) - x[:, 0]

    def pullback(dy):
        if not fixed:
            dy = in_memory_order(dy)
        dx = p * dy[:, None]
        dx[:, 0] -= dy
        return dx

    return loss, pullback


PUBLISHED = PublishedOperation(
    project="TransformerEngine",
    operation="fused cross entropy",
    thread="https://github.com/ROCm/TransformerEngine/pull/623",
    fix="https://github.com/ROCm/TransformerEngine/pull/623",
    mistake=(
        "The upstream gradient of loss.sum() has one number and stride 0; the kernel reads on"
        " behind it."
    ),
    shapes={"x": "batch classes"},
    function=cross_entropy,
)
