"""Deep Learning from Scratch 2: recurrent step."""

import numpy as np

from studies.gradients.published import PublishedOperation


def step(x, h, wx, wh, b):
    y = np.tanh(h @ wh + x @ wx + b)

    def pullback(dy):
        dt = dy * (1 - y**2)
        return dt @ wx.T, dt @ wh.T, x.T @ dt, h.T @ dt, dt.sum(axis=0)

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="recurrent step",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={
        "x": "batch channels",
        "h": "batch hidden",
        "wx": "channels hidden",
        "wh": "hidden hidden",
        "b": "hidden",
    },
    function=step,
)
