"""Deep Learning from Scratch 2: GRU step."""

import numpy as np

from studies.gradients.published import PublishedOperation


def gru(x, h, wx, wh):
    return step(x, h, wx, wh)


def sigmoid(a):
    return 1 / (1 + np.exp(-a))


def step(x, h, wx, wh):
    (xz, xr, xn), (hz, hr, hn) = np.split(wx, 3, axis=1), np.split(wh, 3, axis=1)
    z, r = sigmoid(x @ xz + h @ hz), sigmoid(x @ xr + h @ hr)
    n = np.tanh(x @ xn + (r * h) @ hn)

    def pull(dy):
        dn = dy * z * (1 - n**2)
        drh = dn @ hn.T
        dz, dr = (dy * n - dy * h) * z * (1 - z), drh * h * r * (1 - r)
        dh = dy * (1 - z) + r * drh + dz @ hz.T + dr @ hr.T
        dx = dn @ xn.T + dz @ xz.T + dr @ xr.T
        dwh = np.hstack((h.T @ dz, h.T @ dr, (r * h).T @ dn))
        return dx, dh, x.T @ np.hstack((dz, dr, dn)), dwh

    return (1 - z) * h + z * n, pull


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="GRU step",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={
        "x": "batch channels",
        "h": "batch hidden",
        "wx": "channels 3*hidden",
        "wh": "hidden 3*hidden",
    },
    function=gru,
)
