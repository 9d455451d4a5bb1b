"""The solutions of lessons 05 to 08: the network of the first paper, and what it is used for.

The last two are those of lesson 14, which compares motions.
"""

import numpy as np

from numpy_cae.ops import (
    arctanh,
    conv1d,
    max_pool,
    mean_absolute,
    mean_squared_error,
    tanh,
    transpose_filters,
    unpool_even,
    unpool_random,
)


def encode_layer(x, w, b):
    """Equation 1: tanh of the pooled convolution, and its pullback."""
    convolved, convolve_back = conv1d(x, w, b)
    pooled, pool_back = max_pool(convolved)
    y, tanh_back = tanh(pooled)

    def pullback(dy):
        return convolve_back(pool_back(tanh_back(dy)))

    return y, pullback


def decode_layer(y, w, b, bound):
    """Equation 2: arctanh, unpool, subtract b, convolve with W̃; and its pullback."""
    activated, arctanh_back = arctanh(y, bound)
    unpooled, unpool_back = unpool_even(activated)
    w_tilde, transpose_back = transpose_filters(w)
    nothing = np.zeros(w.shape[1], dtype=w.dtype)
    x, convolve_back = conv1d(unpooled - b, w_tilde, nothing)

    def pullback(dx):
        d_unpooled, dw_tilde, _ = convolve_back(dx)
        dy = arctanh_back(unpool_back(d_unpooled))
        return dy, transpose_back(dw_tilde), -d_unpooled.sum(axis=(0, 1))

    return x, pullback


def project_layer(x, w, b, bound):
    """Equation 2 of equation 1 with the same w and b, and its pullback."""
    y, encode_back = encode_layer(x, w, b)
    x_hat, decode_back = decode_layer(y, w, b, bound)

    def pullback(dx_hat):
        dy, dw_down, db_down = decode_back(dx_hat)
        dx, dw_up, db_up = encode_back(dy)
        return dx, dw_up + dw_down, db_up + db_down

    return x_hat, pullback


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


def frames_seen(taps, layers):
    """The number of input frames that one hidden frame of the top layer depends on."""
    frames = 1
    for _ in range(layers):
        frames = 2 * frames + taps - 1
    return frames


def stage_inputs(x, layers):
    """The clean input that each layer learns to reproduce, lowest first."""
    inputs = [x]
    for w, b in layers[:-1]:
        y, _ = encode_layer(inputs[-1], w, b)
        inputs.append(y)
    return inputs


def stack_loss(x, corrupted, layers, bound):
    """The mean squared error of the whole stack, and its gradients layer by layer."""
    y = corrupted
    up_backs = []
    for w, b in layers:
        y, back = encode_layer(y, w, b)
        up_backs.append(back)
    x_hat = y
    down_backs = []
    for w, b in reversed(layers):
        x_hat, back = decode_layer(x_hat, w, b, bound)
        down_backs.append(back)
    loss, loss_back = mean_squared_error(x_hat, x)

    d = loss_back()
    down = []
    for back in reversed(down_backs):
        d, dw, db = back(d)
        down.append((dw, db))  # the lowest layer was decoded last and comes first here
    up = []
    for back in reversed(up_backs):
        d, dw, db = back(d)
        up.append((dw, db))
    up.reverse()
    gradients = [(dw1 + dw2, db1 + db2) for (dw1, db1), (dw2, db2) in zip(up, down, strict=True)]
    return loss, gradients


def momentum_step(parameter, velocity, gradient, rate, momentum):
    """v ← μ v - η · dL/dθ,   θ ← θ + v   (Polyak 1964)."""
    velocity = momentum * velocity - rate * gradient
    return parameter + velocity, velocity


def adam_step(parameter, mean, square, gradient, rate, step):
    """Adam with β₁ = 0.9, β₂ = 0.99 (Kingma and Ba 2015, algorithm 1); steps count from 1."""
    mean = 0.9 * mean + 0.1 * gradient
    square = 0.99 * square + 0.01 * gradient**2
    unbiased_mean = mean / (1 - 0.9**step)
    unbiased_square = square / (1 - 0.99**step)
    parameter = parameter - rate * unbiased_mean / (np.sqrt(unbiased_square) + 1e-8)
    return parameter, mean, square


def one_cycle(peak, share):
    """Half a cosine up from peak / 25 in 30% of the steps, then half a cosine down to 0."""
    if share < 0.3:
        return peak / 25 + (peak - peak / 25) * (1 - np.cos(np.pi * share / 0.3)) / 2
    return peak * (1 + np.cos(np.pi * (share - 0.3) / 0.7)) / 2


def rescale(x):
    """x / (1 - p̂), p̂ being the share of zeros in each window."""
    zero = x == 0
    counted = ~zero.all(axis=1, keepdims=True)
    lost = (zero & counted).sum(axis=(1, 2), keepdims=True)
    entries = x.shape[1] * counted.sum(axis=(1, 2), keepdims=True)
    p = lost / np.maximum(entries, 1)
    return x / (1 - p).astype(x.dtype)


def complete(x, known, project, interpolate, rounds):
    """Interpolated; in each round the projection, and what it misses, interpolated."""
    completed = interpolate(x, known)
    for _ in range(rounds):
        projected = project(completed)
        missed = interpolate(x - projected, known)
        completed = np.where(known, x, projected + missed)
    return completed


def denoising_weights(second, cross, kept):
    """A of M A = B, the means over all masks that keep a value with one probability."""
    m = kept**2 * second
    np.fill_diagonal(m, kept * np.diag(second))
    return np.linalg.solve(m, kept * cross)


def hidden_from_visible(visible, hidden, complete, ridge):
    """The mean and x B, with B = (XᵀX + λ tr(XᵀX) I)⁻¹ Xᵀ Y of the complete frames."""
    mean = hidden[complete].mean(axis=0)
    x = visible - visible[complete].mean(axis=0)
    rows = x[complete]
    moments = rows.T @ rows
    moments = moments + ridge * np.trace(moments) * np.eye(len(moments))
    b = np.linalg.solve(moments, rows.T @ (hidden[complete] - mean))
    return mean + x @ b


def G(y_0, y_1):
    """Equation 4: squared differences of the largest and smallest values of each unit."""
    largest = y_0.max(axis=0) - y_1.max(axis=0)
    smallest = y_0.min(axis=0) - y_1.min(axis=0)
    return np.sum(largest**2) + np.sum(smallest**2)


def average_precision(distances, alike):
    """The mean precision at the rank of each motion that is alike."""
    ranked = alike[np.argsort(distances)]
    precision = np.cumsum(ranked) / np.arange(1, len(ranked) + 1)
    return precision[ranked].mean()
