"""Deep Learning from Scratch: batch normalisation."""

import numpy as np

from studies.gradients.published import PublishedOperation


def batch_norm(x, gain, shift):
    centred = x - x.mean(axis=0)
    deviation = np.sqrt(np.mean(centred**2, axis=0) + 1e-6)
    normalised = centred / deviation

    def pullback(dy):
        dn = gain * dy
        of_deviation = -np.sum(dn * centred, axis=0) / deviation**2
        dc = dn / deviation + centred * of_deviation / deviation / len(x)
        return dc - dc.sum(axis=0) / len(x), np.sum(normalised * dy, axis=0), dy.sum(axis=0)

    return gain * normalised + shift, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch",
    operation="batch normalisation",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch/blob/master/common/layers.py",
    shapes={"x": "batch features", "gain": "features", "shift": "features"},
    function=batch_norm,
)
