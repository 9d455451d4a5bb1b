"""Variants of the paper's network: pooling by the mean, and a decoder with its own weights.

Φ_k(X)  = tanh(Ψ(X * W_k + b_k))             Ψ is the maximum, or the mean, of each pair
Φ_k†(Y) = (Ψ†(tanh⁻¹(Y)) - c_k) * Ṽ_k        V_k = W_k and c_k = b_k, or learned separately
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae import ops
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.models.conv_autoencoder import loss_and_shares
from numpy_cae.ops.shapes import Pullback


def average_pool(x: np.ndarray) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """y[t] = (x[2t] + x[2t + 1]) / 2: (B, T, C) to (B, T/2, C). The pullback unpools evenly."""
    if x.shape[1] % 2:
        raise ValueError(f"x has shape {x.shape}, expected an even number of frames")
    return (x[:, 0::2] + x[:, 1::2]) / 2, lambda dy: ops.unpool_even(dy)[0]


class AverageLayer(ConvLayer):
    """A layer that pools by the mean."""

    def encode_with_pullback(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        """tanh(Ψ(X * W + b)): (B, T, C) to (B, T/2, D), and dy -> (dx, dw, db)."""
        convolved, convolve_back = ops.conv1d(x, self.w, self.b)
        pooled, pool_back = average_pool(convolved)
        y, tanh_back = ops.tanh(pooled)
        return y, lambda dy: convolve_back(pool_back(tanh_back(dy)))


class AverageAutoencoder(ConvAutoencoder):
    """A stack of `AverageLayer`; of a class of its own, so that `accelerate` leaves it as it is."""


@dataclass
class UntiedLayer(ConvLayer):
    """A layer whose decoder has the filters v (K, C, D) and the biases c (D,)."""

    v: np.ndarray
    c: np.ndarray

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """The learned arrays by name."""
        return {"w": self.w, "b": self.b, "v": self.v, "c": self.c}

    def decode_with_pullback(
        self, y: np.ndarray, first: np.ndarray | None = None
    ) -> tuple[np.ndarray, Pullback]:
        """(Ψ†(tanh⁻¹(Y)) - c) * Ṽ, as `ConvLayer`, and dx -> (dy, dv, dc)."""
        return ConvLayer(self.v, self.c, self.bound).decode_with_pullback(y, first)


class UntiedAutoencoder(ConvAutoencoder):
    """A stack of `UntiedLayer`: the gradients of the encoder and the decoder are not added."""

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> tuple[float, list[tuple[np.ndarray, ...]]]:
        """As `ConvAutoencoder`, with the gradients (dw, db, dv, dc) of each layer."""
        layers = self.layers if layer is None else [self.layers[layer]]
        loss, encoder, decoder = loss_and_shares(layers, x, corrupted, alpha, first)
        return loss, [(*one, *other) for one, other in zip(encoder, decoder, strict=True)]


def average_autoencoder(**network) -> ConvAutoencoder:
    """`ConvAutoencoder(**network)` with the same first weights, pooling by the mean."""
    layers = ConvAutoencoder(**network).layers
    return AverageAutoencoder.from_layers([AverageLayer(x.w, x.b, x.bound) for x in layers])


def untied_autoencoder(**network) -> ConvAutoencoder:
    """The same, pooling by the maximum, with first weights of its own for the decoder."""
    both = zip(*(ConvAutoencoder(**network).layers for _ in range(2)), strict=True)
    return UntiedAutoencoder.from_layers(
        [UntiedLayer(up.w, up.b, up.bound, down.w, down.b) for up, down in both]
    )
