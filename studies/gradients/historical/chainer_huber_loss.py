"""Chainer: huber_loss."""

import numpy as np

from studies.gradients.published import PublishedOperation


def huber_loss(x, t, *, fixed):
    d = x - t
    y = np.where(np.abs(d) <= 1, 0.5 * d * d, np.abs(d) - 0.5).sum(axis=-1)
    slope = np.clip(d, -1, 1)

    def pullback(dy):
        if fixed:
            return slope * dy[:, None], -slope * dy[:, None]
        else:
            return slope, -slope

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Chainer",
    operation="huber_loss",
    thread="https://github.com/chainer/chainer/issues/1175",
    fix="https://github.com/chainer/chainer/pull/1178",
    mistake=(
        "The upstream gradient is ignored: the gradient is right only if nothing is computed "
        "from the loss."
    ),
    shapes={"x": "batch channels", "t": "batch channels"},
    function=huber_loss,
)
