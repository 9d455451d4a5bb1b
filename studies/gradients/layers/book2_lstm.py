"""Deep Learning from Scratch 2: LSTM step."""

import numpy as np

from studies.gradients.published import PublishedOperation


def lstm(x, h, c, wx, wh, b):
    y, c_next, pull = step(x, h, c, wx, wh, b)

    def pullback(dy):
        dh, dc = np.split(dy, 2, axis=1)
        return pull(dh, dc)

    return np.hstack((y, c_next)), pullback


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
    operation="LSTM step",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={
        "x": "batch channels",
        "h": "batch hidden",
        "c": "batch hidden",
        "wx": "channels 4*hidden",
        "wh": "hidden 4*hidden",
        "b": "4*hidden",
    },
    function=lstm,
)
