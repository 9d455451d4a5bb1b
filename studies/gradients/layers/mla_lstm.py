"""MLAlgorithms: LSTM of one frame."""

import numpy as np

from studies.gradients.published import PublishedOperation


def lstm(x, w, v, *, fixed):
    gate, new = 1 / (1 + np.exp(-x @ w)), np.tanh(x @ v)

    def pullback(dy):
        if fixed:
            dg, dn = dy * new * gate * (1 - gate), dy * gate * (1 - new**2)
            return dg @ w.T + dn @ v.T, x.T @ dg, x.T @ dn
        else:
            slope = 1 / (1 + np.exp(-gate)) * (1 - 1 / (1 + np.exp(-gate)))
            dg, dn = dy * new * slope, dy * gate * (1 - np.tanh(new) ** 2)
            return np.zeros_like(x), x.T @ dg, x.T @ dn

    return gate * new, pullback


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="LSTM of one frame",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/recurrent/lstm.py",
    mistake=(
        "The slopes of the gates are taken at the gates' values, not at their inputs, and no "
        "gradient for x is computed."
    ),
    shapes={"x": "batch channels", "w": "channels hidden", "v": "channels hidden"},
    function=lstm,
)
