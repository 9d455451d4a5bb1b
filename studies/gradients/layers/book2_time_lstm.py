"""Deep Learning from Scratch 2: LSTM."""

import numpy as np

from studies.gradients.published import PublishedOperation


def lstm(x, wx, wh, b):
    h = c = np.zeros((len(x), len(wh)), "f")
    y, pulls = np.empty((*x.shape[:2], len(wh)), "f"), []
    for t in range(x.shape[1]):
        h, c, pull = step(x[:, t], h, c, wx, wh, b)
        y[:, t] = h
        pulls.append(pull)

    def pullback(dy):
        dx, dh, dc, totals = np.empty(x.shape, "f"), 0, 0, [0, 0, 0]
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, dc, *terms = pulls[t](dy[:, t] + dh, dc)
            totals = [total + term for total, term in zip(totals, terms, strict=True)]
        return dx, *totals

    return y, pullback


def sigmoid(a):
    return 1 / (1 + np.exp(-a))


def step(x, h, c, wx, wh, b):
    a = np.split(x @ wx + h @ wh + b, 4, axis=1)
    f, g, i, o = sigmoid(a[0]), np.tanh(a[1]), sigmoid(a[2]), sigmoid(a[3])
    c_next = f * c + g * i

    def pull(dh, dc):
        ds = dc + dh * o * (1 - np.tanh(c_next) ** 2)
        df, dg, di = ds * c * f * (1 - f), ds * i * (1 - g**2), ds * g * i * (1 - i)
        da = np.hstack((df, dg, di, dh * np.tanh(c_next) * o * (1 - o)))
        return da @ wx.T, da @ wh.T, ds * f, x.T @ da, h.T @ da, da.sum(axis=0)

    return o * np.tanh(c_next), c_next, pull


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="LSTM",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={
        "x": "batch frames channels",
        "wx": "channels 4*hidden",
        "wh": "hidden 4*hidden",
        "b": "4*hidden",
    },
    ranges={"wx": (-0.5, 0.5), "wh": (-0.5, 0.5)},
    dtypes=("float32",),
    function=lstm,
)
