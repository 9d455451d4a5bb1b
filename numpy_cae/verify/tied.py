"""The smallest network with tied weights: one layer of holden2015 without its pooling.

W and b act in encoding (equation 1) and in decoding (equation 2), and both add to the gradient.
"""

from collections.abc import Callable

import numpy as np

from numpy_cae.ops import conv1d, tanh, transpose_filters

Pullback = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def tied_layer(x: np.ndarray, w: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """y = tanh(x * W + b),  x̂ = (y - b) * W̃.

        dL/dW = (as encoding returns it) + (dL/dW̃, transposed back)
        dL/db = (as encoding returns it) - Σ dL/d(y - b)

    x and x̂ are (B, T, C), w (K, C, D), b (D,); the pullback returns (dx, dw, db). Raises a
    ValueError if a shape does not fit. holden2015, section 5, equations 1 and 2.
    """
    a, of_encoding = conv1d(x, w, b)
    y, of_tanh = tanh(a)
    w_tilde, of_transpose = transpose_filters(w)
    x_hat, of_decoding = conv1d(y - b, w_tilde, np.zeros(x.shape[-1], dtype=x.dtype))

    def pullback(dx_hat: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        dy, dw_tilde, _ = of_decoding(dx_hat)
        dx, dw, db = of_encoding(of_tanh(dy))
        return dx, dw + of_transpose(dw_tilde), db - dy.sum(axis=(0, 1))

    return x_hat, pullback
