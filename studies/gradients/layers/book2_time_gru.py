"""Deep Learning from Scratch 2: GRU."""

import numpy as np

from studies.gradients.published import PublishedOperation


def gru(x, wx, wh):
    h, pulls = np.zeros((len(x), len(wh)), "f"), []
    y = np.empty((*x.shape[:2], len(wh)), "f")
    for t in range(x.shape[1]):
        h, pull = step(x[:, t], h, wx, wh)
        y[:, t] = h
        pulls.append(pull)

    def pullback(dy):
        dx, dh, dwx, dwh = np.empty(x.shape, "f"), 0, 0, 0
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, a, b = pulls[t](dy[:, t] + dh)
            dwx, dwh = dwx + a, dwh + b
        return dx, dwx, dwh

    return y, pullback


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
    operation="GRU",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={"x": "batch frames channels", "wx": "channels 3*hidden", "wh": "hidden 3*hidden"},
    ranges={"wx": (-0.5, 0.5), "wh": (-0.5, 0.5)},
    dtypes=("float32",),
    function=gru,
)
