"""Deep Learning from Scratch: max pooling by columns."""

import numpy as np

from studies.gradients.published import PublishedOperation


def pooling(x):
    batch, channels, rows, _ = x.shape
    columns = x.reshape(batch, channels, rows // 2, 4)
    winner = columns.argmax(axis=3)[..., None]

    def pullback(dy):
        dx = np.zeros(columns.shape, dy.dtype)
        np.put_along_axis(dx, winner, dy[..., None], axis=3)
        return dx.reshape(x.shape)

    return columns.max(axis=3), pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch",
    operation="max pooling by columns",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch/blob/master/common/layers.py",
    shapes={"x": "batch channels 2*rows 2"},
    function=pooling,
)
