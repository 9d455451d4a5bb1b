"""The solutions of lesson 05, one layer."""

import numpy as np

from numpy_cae.ops import arctanh, conv1d, max_pool, tanh, transpose_filters, unpool_even


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
