"""Caffe: SoftmaxWithLoss with loss_weight 0."""

import numpy as np

from studies.gradients.published import PublishedOperation


def softmax_loss(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    total = e.sum(axis=-1, keepdims=True)
    loss = (np.log(total[:, 0]) + x.max(axis=-1) - x[:, 0]).sum()

    def pullback(dloss):
        dx = e / total
        if not fixed:
            if dloss == 0:
                return dx
        dx[:, 0] -= 1
        return dloss * dx

    return loss, pullback


PUBLISHED = PublishedOperation(
    project="Caffe",
    operation="SoftmaxWithLoss with loss_weight 0",
    thread="https://github.com/BVLC/caffe/pull/3868",
    fix="https://github.com/BVLC/caffe/pull/3868",
    mistake=(
        "With the upstream gradient 0 the backward step is skipped, and the buffer of the "
        "gradient still holds the probabilities."
    ),
    shapes={"x": "batch classes"},
    function=softmax_loss,
)
