"""The value of every operation, computed loop by loop, one number at a time.

Slow but easy to check by reading: the definitions of `numpy_cae.ops` are tested against these.
"""

import math

import numpy as np


def conv1d(x, w, b):
    (batch, frames, channels), (taps, _, filters) = x.shape, w.shape
    y = np.zeros((batch, frames, filters))
    for i, t, d in np.ndindex(y.shape):
        y[i, t, d] = b[d]
        for k in range(taps):
            for c in range(channels):
                if 0 <= t + k - taps // 2 < frames:
                    y[i, t, d] += x[i, t + k - taps // 2, c] * w[k, c, d]
    return y


def transpose_filters(w):
    taps, channels, filters = w.shape
    w_tilde = np.zeros((taps, filters, channels))
    for k, c, d in np.ndindex(w.shape):
        w_tilde[taps - 1 - k, d, c] = w[k, c, d]
    return w_tilde


def max_pool(x):
    y = np.zeros((x.shape[0], x.shape[1] // 2, x.shape[2]))
    for i, t, c in np.ndindex(y.shape):
        y[i, t, c] = max(x[i, 2 * t, c], x[i, 2 * t + 1, c])
    return y


def unpool_even(y):
    x = np.zeros((y.shape[0], 2 * y.shape[1], y.shape[2]))
    for i, t, c in np.ndindex(x.shape):
        x[i, t, c] = y[i, t // 2, c] / 2
    return x


def unpool_random(y, first):
    x = np.zeros((y.shape[0], 2 * y.shape[1], y.shape[2]))
    for i, t, c in np.ndindex(y.shape):
        x[i, 2 * t + (0 if first[i, t, c] else 1), c] = y[i, t, c]
    return x


def tanh(x):
    return np.vectorize(math.tanh, otypes=[float])(x)


def sigmoid(x):
    return np.vectorize(_sigmoid, otypes=[float])(x)


def arctanh(y, bound):
    clipped = np.vectorize(lambda entry: min(max(entry, -bound), bound), otypes=[float])(y)
    return np.vectorize(math.atanh, otypes=[float])(clipped)


def tied_layer(x, w, b):
    y = tanh(conv1d(x, w, b))
    return conv1d(y - b, transpose_filters(w), np.zeros(x.shape[-1]))


def linear(x, w, b):
    y = np.zeros((*x.shape[:-1], w.shape[1]))
    for *row, d in np.ndindex(y.shape):
        y[(*row, d)] = b[d] + sum(x[(*row, c)] * w[c, d] for c in range(w.shape[0]))
    return y


def gru_step(x, h, w, u, b, c):
    batch, hidden = h.shape
    h_next = np.zeros((batch, hidden))
    for i, j in np.ndindex(h_next.shape):
        reset, update, new = j, hidden + j, 2 * hidden + j
        a = {g: b[g] + sum(x[i] * w[:, g]) for g in (reset, update, new)}
        s = {g: c[g] + sum(h[i] * u[:, g]) for g in (reset, update, new)}
        r, z = _sigmoid(a[reset] + s[reset]), _sigmoid(a[update] + s[update])
        n = math.tanh(a[new] + r * s[new])
        h_next[i, j] = (1 - z) * n + z * h[i, j]
    return h_next


def gru(x, h0, w, u, b, c):
    y = np.zeros((*x.shape[:2], h0.shape[1]))
    h = h0
    for t in range(x.shape[1]):
        h = y[:, t] = gru_step(x[:, t], h, w, u, b, c)
    return y


def mean_squared_error(x_hat, x):
    return sum((a - b) ** 2 for a, b in zip(x_hat.flat, x.flat, strict=True)) / x.size


def mean_absolute(y):
    return sum(abs(entry) for entry in y.flat) / y.size


def sliced_wasserstein(z, prior, directions):
    total = 0.0
    for theta in directions:
        p = sorted(sum(point * theta) for point in z)
        q = sorted(sum(point * theta) for point in prior)
        total += sum((a - b) ** 2 for a, b in zip(p, q, strict=True))
    return total / (len(directions) * len(z))


def _sigmoid(number):
    return (1 + math.tanh(number / 2)) / 2
