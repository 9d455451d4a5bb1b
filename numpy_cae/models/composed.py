"""Equations 1 to 3 for a stack of layers, composed of `numpy_cae.ops`: the definition.

Operations forwards in their order, pullbacks backwards in reverse order. `ConvAutoencoder` computes
the same by `numpy_cae.fast.network`, which tests hold equal to what stands here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae import ops
from numpy_cae.models.conv_layer import ConvLayer

Gradients = list[tuple[np.ndarray, np.ndarray]]
Objective = Callable[[np.ndarray], tuple[float, np.ndarray]]
"""From X̂ to a loss and its gradient for X̂."""


def encode(layers: Sequence[ConvLayer], x: np.ndarray) -> np.ndarray:
    """Y = Φ(X) = Φ_n(…Φ_1(X)): windows (B, T, C) to hidden units (B, T / 2^n, D)."""
    for layer in layers:
        x, _ = layer.encode(x)
    return x


def decode(layers: Sequence[ConvLayer], y: np.ndarray) -> np.ndarray:
    """X̂ = Φ†(Y) = Φ_1†(…Φ_n†(Y)), unpooling evenly: (B, t, D) to (B, t · 2^n, C)."""
    for layer in reversed(layers):
        y, _ = layer.decode(y)
    return y


def latent_gradient(
    layers: Sequence[ConvLayer], y: np.ndarray, objective: Objective
) -> tuple[float, np.ndarray]:
    """L(Φ†(Y)) and its gradient for Y, unpooling evenly: what descends along the manifold.

    Parameters
    ----------
    layers : sequence of ConvLayer, lowest first
    y : (B, t, D) array of float
    objective : function, X̂ (B, T, C) -> (L, dL/dX̂)

    Returns
    -------
    loss : float
    dy : (B, t, D) array
    """
    x_hat, backs = y, []
    for layer in reversed(layers):
        x_hat, back = layer.decode(x_hat)
        backs.append(back)
    loss, d = objective(x_hat)
    for back in reversed(backs):
        d, _, _ = back(d)
    return loss, d


def loss_and_gradients(
    layers: Sequence[ConvLayer],
    x: np.ndarray,
    corrupted: np.ndarray,
    alpha: float = 0.0,
    first: Sequence[np.ndarray] | None = None,
) -> tuple[float, Gradients]:
    """Equation 3 and its derivatives.

        Loss = mean((X - Φ†(Φ(X_c)))²) + α · mean(|Φ(X_c)|)

    W and b stand in both directions of a layer, so each gradient is a sum of two.

    Parameters
    ----------
    layers : sequence of ConvLayer, lowest first
    x, corrupted : (B, T, C) arrays of float
    alpha : float
    first : one (B, T_k, D_k) array of bool for each layer, lowest first, optional
        Masks for unpooling at random; evenly where None.

    Returns
    -------
    loss : float
    gradients : list of (dw, db), lowest layer first

    References
    ----------
    holden2015, section 6, equation 3.
    """
    loss, up, down = loss_both_ways(layers, x, corrupted, alpha, first)
    gradients = [
        (dw_up + dw_down, db_up + db_down)
        for (dw_up, db_up), (dw_down, db_down) in zip(up, down, strict=True)
    ]
    return loss, gradients


def loss_both_ways(
    layers: Sequence[ConvLayer],
    x: np.ndarray,
    corrupted: np.ndarray,
    alpha: float,
    first: Sequence[np.ndarray] | None,
) -> tuple[float, Gradients, Gradients]:
    """Equation 3, and what (dw, db) of each layer, lowest first, are on the way up and down."""
    masks = [None] * len(layers) if first is None else list(first)

    y, encode_backs = corrupted, []
    for layer in layers:
        y, back = layer.encode(y)
        encode_backs.append(back)
    x_hat, decode_backs = y, []
    for layer, mask in zip(reversed(layers), reversed(masks), strict=True):
        x_hat, back = layer.decode(x_hat, mask)
        decode_backs.append(back)
    error, error_back = ops.mean_squared_error(x_hat, x)
    activity, activity_back = ops.mean_absolute(y)
    loss = error + alpha * activity

    down = []
    d = error_back()
    for back in reversed(decode_backs):
        d, dw, db = back(d)
        down.append((dw, db))
    up = []
    d = d + activity_back(alpha)
    for back in reversed(encode_backs):
        d, dw, db = back(d)
        up.append((dw, db))
    return float(loss), up[::-1], down
