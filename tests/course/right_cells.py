"""Right answers to four exercises, as the cells of a notebook have them."""

import numpy as np

from numpy_cae.ops import conv1d, max_pool


def encode_layer(x, w, b):
    convolved, convolve_back = conv1d(x, w, b)
    pooled, pool_back = max_pool(convolved)
    y, tanh_back = tanh(pooled)
    return y, lambda dy: convolve_back(pool_back(tanh_back(dy)))


def tanh(x):
    y = np.tanh(x)
    return y, lambda dy: dy * (1 - y * y)


def speeds(positions, rate):
    return rate * np.sqrt((np.diff(positions, axis=0) ** 2).sum(axis=-1))


def frames_seen(taps, layers):
    n = 1
    for _ in range(layers):
        n = 2 * n + taps - 1
    return n
