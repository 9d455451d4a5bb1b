"""MLAlgorithms: batch normalisation in nine steps."""

import numpy as np

from studies.gradients.published import PublishedOperation


def batch_norm(x, gain, shift):
    count = len(x)
    centred = x - np.sum(x, axis=0) / count
    deviation = np.sqrt(np.sum(centred**2, axis=0) / count + 1e-5)
    inverse = 1.0 / deviation
    n = centred * inverse

    def pullback(dy):
        dn = dy * gain
        of_deviation = -np.sum(dn * centred, axis=0) / deviation**2
        of_variance = 0.5 / deviation * of_deviation
        d = dn * inverse + 2 * centred * np.ones(x.shape) / count * of_variance
        dx = d - np.ones(x.shape) / count * np.sum(d, axis=0)
        return dx, np.sum(dy * n, axis=0), np.sum(dy, axis=0)

    return gain * n + shift, pullback


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="batch normalisation in nine steps",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/normalization.py",
    shapes={"x": "batch features", "gain": "features", "shift": "features"},
    function=batch_norm,
)
