"""One layer of holden2015's autoencoder: equation 1 encodes, equation 2 decodes, with one W and b.

Encoding and decoding apply their operations in order. The pullback applies the operations'
pullbacks in reverse order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from numpy_cae import ops
from numpy_cae.ops.shapes import Pullback


@dataclass(eq=False)
class ConvLayer:
    """Filters and biases that the encoder and the decoder share ("tied" weights).

    Parameters
    ----------
    w : (K, C, D) array of float
        W_k, D filters of K taps over C channels.
    b : (D,) array of float
        b_k.
    bound : float
        Where the decoder's `arctanh` clips, below 1.

    Examples
    --------
    >>> layer = ConvLayer.initial(3, 5, 8, bound=0.9, rng=np.random.default_rng(0))
    >>> y, pullback = layer.encode_with_pullback(np.zeros((2, 16, 5), np.float32))
    >>> dx, dw, db = pullback(np.ones_like(y))
    >>> y.shape, dw.shape
    ((2, 8, 8), (3, 5, 8))
    """

    w: np.ndarray
    b: np.ndarray
    bound: float

    @classmethod
    def initial(
        cls,
        taps: int,
        channels: int,
        filters: int,
        bound: float,
        rng: np.random.Generator,
        dtype: np.dtype | type = np.float32,
    ) -> ConvLayer:
        """Small random filters by fan-in and fan-out, zero biases (section 5).

        Glorot initialisation, W uniform within ±√(6 / (fan_in + fan_out)): the variance is a
        compromise between those that preserve signals (fan-in K·C) and gradients (fan-out K·D).
        """
        width = np.sqrt(6 / (taps * channels + taps * filters))
        w = rng.uniform(-width, width, size=(taps, channels, filters))
        return cls(w.astype(dtype), np.zeros(filters, dtype=dtype), bound)

    def encode_with_pullback(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        """Φ_k(X) = tanh(Ψ(X * W_k + b_k)), equation 1.

        Parameters
        ----------
        x : (B, T, C) array of float

        Returns
        -------
        y : (B, T/2, D) array, within [-1, 1]
        pullback : dy -> (dx, dw, db)
            With V = X * W + b before pooling; Ψ' puts a value on the larger frame of its pair:
            dV = Ψ'((1 - Y²) ∘ dY),  dX = dV * W̃,  dW[k] = Σ_t X[t+k-K//2]ᵀ dV[t],  db = Σ_t dV[t]
        """
        convolved, convolve_pullback = ops.conv1d(x, self.w, self.b)  # (B, T, D)
        pooled, pool_pullback = ops.max_pool(convolved)  # (B, T/2, D)
        y, tanh_pullback = ops.tanh(pooled)

        def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return convolve_pullback(pool_pullback(tanh_pullback(dy)))

        return y, pullback

    def decode_with_pullback(
        self, y: np.ndarray, first: np.ndarray | None = None
    ) -> tuple[np.ndarray, Pullback]:
        """Φ_k†(Y) = (Ψ†(tanh⁻¹(Y)) - b_k) * W̃_k, equation 2.

        Parameters
        ----------
        y : (B, T, D) array of float
        first : (B, T, D) array of bool, optional
            The mask of `ops.unpool_random`: unpool at random, to the first frame of a pair where
            True and to the second where False. Unpool evenly where None.

        Returns
        -------
        x : (B, 2T, C) array
        pullback : dx -> (dy, dw, db)
            With U = Ψ†(tanh⁻¹(Y)) - b, so that X = U * W̃:
            dU = dX * W,  dW̃[k] = Σ_t U[t+k-K//2]ᵀ dX[t],  dW[k] = dW̃[K-1-k]ᵀ,  db = -Σ_t dU[t],
            dY = Ψ†ᵀ(dU) / (1 - Y²), but 0 where |Y| > bound. Ψ†ᵀ is half the sum of each pair of
            frames or, with `first`, the value of the frame that was picked.
        """
        activated, arctanh_pullback = ops.arctanh(y, self.bound)
        if first is None:
            unpooled, unpool_pullback = ops.unpool_even(activated)
        else:
            unpooled, unpool_pullback = ops.unpool_random(activated, first)
        w_tilde, transpose_pullback = ops.transpose_filters(self.w)  # (K, D, C)
        # Equation 2 adds nothing after its convolution: the bias is subtracted before it.
        no_bias = np.zeros(self.w.shape[1], dtype=self.w.dtype)
        x, convolve_pullback = ops.conv1d(unpooled - self.b, w_tilde, no_bias)  # (B, 2T, C)

        def pullback(dx: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            d_unpooled, dw_tilde, _ = convolve_pullback(dx)
            dy = arctanh_pullback(unpool_pullback(d_unpooled))
            dw = transpose_pullback(dw_tilde)
            db = -d_unpooled.sum(axis=(0, 1))
            return dy, dw, db

        return x, pullback
