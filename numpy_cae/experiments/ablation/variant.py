"""Variants of holden2015's network: pooling by the mean, weights that are not tied.

    Φ_k(X)  = tanh(Ψ(X * W_k + b_k))             Ψ the maximum, or the mean, of each pair
    Φ_k†(Y) = (Ψ†(tanh⁻¹(Y)) - c_k) * V_k        V_k = W̃_k and c_k = b_k, or independent ones

With the maximum and tied weights it is `ConvAutoencoder`, and a test compares the two. It computes
with the operations of `numpy_cae.ops`, except for the convolution, which is that of
`numpy_cae.fast`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from numpy_cae import ops
from numpy_cae.fast import conv1d
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.models.conv_autoencoder import loss_and_shares, require_loss_arguments
from numpy_cae.models.conv_layer import LayerPullback

Pool = Callable[[np.ndarray], tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]]


class VariantLayer:
    """One layer: W and b in the encoder; in the decoder the same, or V and c.

    Parameters
    ----------
    encoder : ConvLayer
        W, b and the bound of `arctanh`.
    pool : function
        `ops.max_pool` or `average_pool`.
    decoder : ConvLayer, optional
        The layer whose W̃ and b are the initial V and c. Tied where None.
    """

    def __init__(self, encoder: ConvLayer, pool: Pool, decoder: ConvLayer | None = None):
        self.w, self.b, self.bound, self.pool = encoder.w, encoder.b, encoder.bound, pool
        self.v, self.c = None, None
        if decoder is not None:
            self.v, self.c = ops.transpose_filters(decoder.w)[0], decoder.b

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """The learned arrays by name: w and b; untied, v and c too."""
        tied = {"w": self.w, "b": self.b}
        return tied if self.v is None else tied | {"v": self.v, "c": self.c}

    def encode_with_pullback(self, x: np.ndarray) -> tuple[np.ndarray, LayerPullback]:
        """tanh(Ψ(X * W + b)): (B, T, C) to (B, T/2, D), and dy -> (dx, dw, db)."""
        convolved, convolve_pullback = conv1d(x, self.w, self.b)
        pooled, pool_pullback = self.pool(convolved)
        y, tanh_pullback = ops.tanh(pooled)

        def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return convolve_pullback(pool_pullback(tanh_pullback(dy)))

        return y, pullback

    def decode_with_pullback(
        self, y: np.ndarray, first: np.ndarray | None = None
    ) -> tuple[np.ndarray, LayerPullback]:
        """(Ψ†(tanh⁻¹(Y)) - c) * V: (B, T, D) to (B, 2T, C), and dx -> (dy, dv, dc).

        Parameters
        ----------
        y : (B, T, D) array of float
        first : (B, T, D) array of bool, optional
            Unpool at random, to the first frame of a pair where True; evenly where None.
        """
        v, c = self._decoder_weights()
        activated, arctanh_pullback = ops.arctanh(y, self.bound)
        if first is None:
            unpooled, unpool_pullback = ops.unpool_even(activated)
        else:
            unpooled, unpool_pullback = ops.unpool_random(activated, first)
        x, convolve_pullback = conv1d(unpooled - c, v, np.zeros(v.shape[2], v.dtype))

        def pullback(dx: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            d_unpooled, dv, _ = convolve_pullback(dx)
            return arctanh_pullback(unpool_pullback(d_unpooled)), dv, -d_unpooled.sum(axis=(0, 1))

        return x, pullback

    def gradients(
        self, encoder_share: Sequence[np.ndarray], decoder_share: Sequence[np.ndarray]
    ) -> tuple[np.ndarray, ...]:
        """The gradients of `parameters`, from (dw, db) of the encoder and (dv, dc) of the decoder.

        Tied, V = W̃ and c = b: each gradient is the sum of both, dV transposed.
        """
        (dw, db), (dv, dc) = encoder_share, decoder_share
        if self.v is not None:
            return dw, db, dv, dc
        _, transpose_pullback = ops.transpose_filters(self.w)
        return dw + transpose_pullback(dv), db + dc

    def _decoder_weights(self) -> tuple[np.ndarray, np.ndarray]:
        if self.v is not None:
            return self.v, self.c
        return ops.transpose_filters(self.w)[0], self.b


class VariantAutoencoder(ConvAutoencoder):
    """`ConvAutoencoder` with another pooling or untied weights.

    Parameters
    ----------
    features, filters, taps, bound, rng, dtype
        As for `ConvAutoencoder`; tied, the initial weights of one seed are the same.
    tied : bool
        Whether the decoder uses the encoder's filters.
    pool : function
        `ops.max_pool` or `average_pool`.

    Attributes
    ----------
    layers : list of VariantLayer
    """

    def __init__(
        self,
        features: int = 63,
        filters: Sequence[int] = (64, 128, 256),
        taps: int = 15,
        bound: float = 0.9,
        rng: np.random.Generator | None = None,
        dtype: np.dtype | type = np.float32,
        tied: bool = True,
        pool: Pool = ops.max_pool,
    ):
        rng = rng or np.random.default_rng(0)

        def stack() -> list[ConvLayer]:
            sizes = pairwise((features, *filters))
            return [ConvLayer.initial(taps, *size, bound, rng, dtype) for size in sizes]

        encoder = stack()
        decoder = [None] * len(encoder) if tied else stack()
        self.layers = [
            VariantLayer(up, pool, down) for up, down in zip(encoder, decoder, strict=True)
        ]

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> tuple[float, list[tuple[np.ndarray, ...]]]:
        """Equation 3 and its derivatives, as `ConvAutoencoder.loss_and_gradients`.

        Returns
        -------
        loss : float
        gradients : list of tuples in the order of `VariantLayer.parameters`, lowest layer first
        """
        layers = self.layers if layer is None else [self.layers[layer]]
        require_loss_arguments(layers, x, corrupted, first)
        loss, encoder_shares, decoder_shares = loss_and_shares(layers, x, corrupted, alpha, first)
        return loss, [
            each.gradients(*shares)
            for each, *shares in zip(layers, encoder_shares, decoder_shares, strict=True)
        ]
