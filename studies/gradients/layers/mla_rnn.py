"""MLAlgorithms: recurrent layer of one frame."""

import numpy as np

from studies.gradients.published import PublishedOperation


def rnn(x, w, b, *, fixed):
    y = np.tanh(x @ w + b)

    def pullback(dy):
        if fixed:
            dt = (1 - y**2) * dy
            return dt @ w.T, x.T @ dt, dt.sum(axis=0)
        else:
            dt = (1 - np.tanh(y) ** 2) * dy
            return dt @ w.T, x.T @ dt, dy.sum(axis=0)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="recurrent layer of one frame",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/recurrent/rnn.py",
    mistake=(
        "The slope of tanh is taken at its value, not at its input, and the gradient of the "
        "bias has none."
    ),
    shapes={"x": "batch channels", "w": "channels hidden", "b": "hidden"},
    function=rnn,
)
