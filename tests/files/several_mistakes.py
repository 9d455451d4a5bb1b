"""A student's file in which each function is right or wrong in its own way."""

import numpy as np


def tanh(x):
    y = np.tanh(x)
    return y, lambda dy: dy * (1 - x * x)


def sigmoid(a):
    y = 1 / (1 + np.exp(-a))
    return y, lambda dy: dy * y * (1 - y)


def linear(x, w, b):
    raise RuntimeError("\x1b[2J" + "x" * 10**6)


def mean_squared_error(x_hat, x):
    e = x_hat - x
    return np.mean(e * e) / 2, lambda dloss=1.0: e * e.dtype.type(dloss / e.size)
