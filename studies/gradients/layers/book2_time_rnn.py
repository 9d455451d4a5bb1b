"""Deep Learning from Scratch 2: recurrent layer."""

import numpy as np

from studies.gradients.published import PublishedOperation


def recurrent(x, wx, wh, b):
    states = [np.zeros((len(x), len(wh)), "f")]
    y = np.empty((*x.shape[:2], len(wh)), "f")
    for t in range(x.shape[1]):
        states.append(np.tanh(states[-1] @ wh + x[:, t] @ wx + b))
        y[:, t] = states[-1]

    def pullback(dy):
        dx = np.empty(x.shape, "f")
        dh, dwx, dwh, db = 0, 0, 0, 0
        for t in reversed(range(x.shape[1])):
            dt = (dy[:, t] + dh) * (1 - states[t + 1] ** 2)
            dx[:, t], dh = dt @ wx.T, dt @ wh.T
            dwx, dwh, db = dwx + x[:, t].T @ dt, dwh + states[t].T @ dt, db + dt.sum(axis=0)
        return dx, dwx, dwh, db

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="recurrent layer",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={
        "x": "batch frames channels",
        "wx": "channels hidden",
        "wh": "hidden hidden",
        "b": "hidden",
    },
    ranges={"wx": (-0.5, 0.5), "wh": (-0.5, 0.5)},
    dtypes=("float32",),
    function=recurrent,
)
