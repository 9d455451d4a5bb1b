"""MLAlgorithms: max pooling with overlap."""

import numpy as np

from studies.gradients.published import PublishedOperation


def pooling(x):
    pairs = np.stack([x[..., :3], x[..., 1:]], axis=-1)
    winner = np.argmax(pairs, axis=-1)[..., None]

    def pullback(dy):
        d = np.zeros((*dy.shape, 2), dy.dtype)
        np.put_along_axis(d, winner, dy[..., None], axis=-1)
        dx = np.zeros(x.shape, dy.dtype)
        dx[..., :3] += d[..., 0]
        dx[..., 1:] += d[..., 1]
        return dx

    return np.max(pairs, axis=-1), pullback


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="max pooling with overlap",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/convnet.py",
    shapes={"x": "batch channels 4"},
    function=pooling,
)
