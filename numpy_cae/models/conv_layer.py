"""One layer of holden2015's autoencoder: equation 1 up, equation 2 down, one W and one b for both.

Each direction is its operations in order; each pullback is theirs in reverse order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from numpy_cae import ops

LayerPullback = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


@dataclass
class ConvLayer:
    """Filters and biases, tied: the decoder has no others.

    Parameters
    ----------
    w : (K, C, D) array of float
        W_k, D filters of K taps over C channels.
    b : (D,) array of float
        b_k.
    bound : float
        Where `arctanh` clips, below 1.
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

        W is uniform within ±√(6 / (fan_in + fan_out)): wide enough that signals keep their size
        going up (K·C inputs to a sum), narrow enough that gradients keep theirs going down (K·D).
        """
        width = np.sqrt(6 / (taps * channels + taps * filters))
        w = rng.uniform(-width, width, size=(taps, channels, filters)).astype(dtype)
        return cls(w, np.zeros(filters, dtype=dtype), bound)

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """What is learned, by name."""
        return {"w": self.w, "b": self.b}

    def encode(self, x: np.ndarray) -> tuple[np.ndarray, LayerPullback]:
        """Φ_k(X) = tanh(Ψ(X * W_k + b_k)), equation 1.

        Parameters
        ----------
        x : (B, T, C) array of float

        Returns
        -------
        y : (B, T/2, D) array, within [-1, 1]
        pullback : dy -> (dx, dw, db)
        """
        convolved, convolve_back = ops.conv1d(x, self.w, self.b)
        pooled, pool_back = ops.max_pool(convolved)
        y, tanh_back = ops.tanh(pooled)

        def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return convolve_back(pool_back(tanh_back(dy)))

        return y, pullback

    def decode(
        self, y: np.ndarray, first: np.ndarray | None = None
    ) -> tuple[np.ndarray, LayerPullback]:
        """Φ_k†(Y) = (Ψ†(tanh⁻¹(Y)) - b_k) * W̃_k, equation 2.

        Parameters
        ----------
        y : (B, T, D) array of float
        first : (B, T, D) array of bool, optional
            Unpool at random, to the first frame of a pair where True; evenly where None.

        Returns
        -------
        x : (B, 2T, C) array
        pullback : dx -> (dy, dw, db)
        """
        activated, arctanh_back = ops.arctanh(y, self.bound)
        if first is None:
            unpooled, unpool_back = ops.unpool_even(activated)
        else:
            unpooled, unpool_back = ops.unpool_random(activated, first)
        w_tilde, transpose_back = ops.transpose_filters(self.w)
        # Equation 2 adds nothing after its convolution: the bias is inside, subtracted.
        nothing = np.zeros(self.w.shape[1], dtype=self.w.dtype)
        x, convolve_back = ops.conv1d(unpooled - self.b, w_tilde, nothing)

        def pullback(dx: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            d_unpooled, dw_tilde, _ = convolve_back(dx)
            dy = arctanh_back(unpool_back(d_unpooled))
            db = -d_unpooled.sum(axis=(0, 1))
            return dy, transpose_back(dw_tilde), db

        return x, pullback
