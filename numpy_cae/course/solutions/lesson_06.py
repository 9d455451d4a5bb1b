"""The solutions of lesson 06, learning."""

import numpy as np

from numpy_cae.ops import (
    arctanh,
    conv1d,
    max_pool,
    mean_absolute,
    mean_squared_error,
    tanh,
    transpose_filters,
    unpool_random,
)


def zero_values(x, p, draws):
    """x, and 0 where the draw is below p."""
    return np.where(draws < p, 0, x)


def sgd_step(parameter, gradient, rate, decay, epoch):
    """θ - η_0 · decay^epoch · dL/dθ"""
    return parameter - rate * decay**epoch * gradient


def layer_loss(x, corrupted, w, b, first, alpha, bound):
    """Equation 3 of one layer, and its gradients for w and b."""
    convolved, convolve_back = conv1d(corrupted, w, b)
    pooled, pool_back = max_pool(convolved)
    y, tanh_back = tanh(pooled)

    activated, arctanh_back = arctanh(y, bound)
    unpooled, unpool_back = unpool_random(activated, first)
    w_tilde, transpose_back = transpose_filters(w)
    x_hat, decode_back = conv1d(unpooled - b, w_tilde, np.zeros(w.shape[1], dtype=w.dtype))

    error, error_back = mean_squared_error(x_hat, x)
    activity, activity_back = mean_absolute(y)

    d_unpooled, dw_tilde, _ = decode_back(error_back())
    dy = arctanh_back(unpool_back(d_unpooled)) + activity_back(alpha)
    _, dw_up, db_up = convolve_back(pool_back(tanh_back(dy)))
    dw = dw_up + transpose_back(dw_tilde)
    db = db_up - d_unpooled.sum(axis=(0, 1))
    return error + alpha * activity, dw, db


def train_layer(windows, w, b, loss, epochs, batch, rate, decay, p, rng):
    """Section 6: epochs over all windows in a new order; corrupt, compare, descend."""
    weights, losses = [], []
    for epoch in range(epochs):
        order = rng.permutation(len(windows))
        values = []
        for start in range(0, len(windows), batch):
            x = windows[order[start : start + batch]]
            corrupted = zero_values(x, p, rng.random(x.shape))
            value, dw, db = loss(x, corrupted, w, b)
            w = sgd_step(w, dw, rate, decay, epoch)
            b = sgd_step(b, db, rate, decay, epoch)
            values.append(value)
        weights.append((w, b))
        losses.append(np.mean(values))
    return weights, losses
