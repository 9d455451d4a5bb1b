"""What holden2015 might have built instead: other pooling, weights that are not tied.

    Φ_k(X)  = tanh(Ψ(X * W_k + b_k))             Ψ the maximum, or the mean, of each pair
    Φ_k†(Y) = (Ψ†(tanh⁻¹(Y)) - c_k) * V_k        V_k = W̃_k and c_k = b_k, or others of its own

Composed of `numpy_cae.ops`, as `models.composed` is; with the maximum and tied weights it is that
network, and a test holds the two equal. It is for `experiments.ablation`, and slower than the
network that it varies.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from numpy_cae import ops
from numpy_cae.fast.convolution import conv1d
from numpy_cae.models import composed
from numpy_cae.models.conv_layer import ConvLayer, LayerPullback

Pool = Callable[[np.ndarray], tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]]


class VariantLayer:
    """One layer: W and b up; down the same, or V and c.

    Parameters
    ----------
    up : ConvLayer
        W and b, and where `arctanh` clips.
    pool : function
        `ops.max_pool` or `ops.average_pool`.
    down : ConvLayer, optional
        Another layer's filters, turned around: V = W̃ and c = b of it. Tied where None.
    """

    def __init__(self, up: ConvLayer, pool: Pool, down: ConvLayer | None = None):
        self.w, self.b, self.bound, self.pool = up.w, up.b, up.bound, pool
        self.v, self.c = (
            (None, None) if down is None else (ops.transpose_filters(down.w)[0], down.b)
        )

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """What is learned, by name: w and b; untied, v and c too."""
        tied = {"w": self.w, "b": self.b}
        return tied if self.v is None else tied | {"v": self.v, "c": self.c}

    def encode(self, x: np.ndarray) -> tuple[np.ndarray, LayerPullback]:
        """tanh(Ψ(X * W + b)): (B, T, C) to (B, T/2, D), and dy -> (dx, dw, db)."""
        convolved, convolve_back = conv1d(x, self.w, self.b)
        pooled, pool_back = self.pool(convolved)
        y, tanh_back = ops.tanh(pooled)

        def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return convolve_back(pool_back(tanh_back(dy)))

        return y, pullback

    def decode(
        self, y: np.ndarray, first: np.ndarray | None = None
    ) -> tuple[np.ndarray, LayerPullback]:
        """(Ψ†(tanh⁻¹(Y)) - c) * V: (B, T, D) to (B, 2T, C), and dx -> (dy, dv, dc).

        Parameters
        ----------
        y : (B, T, D) array of float
        first : (B, T, D) array of bool, optional
            Unpool at random, to the first frame of a pair where True; evenly where None.
        """
        v, c = self._downwards()
        activated, arctanh_back = ops.arctanh(y, self.bound)
        if first is None:
            unpooled, unpool_back = ops.unpool_even(activated)
        else:
            unpooled, unpool_back = ops.unpool_random(activated, first)
        x, convolve_back = conv1d(unpooled - c, v, np.zeros(v.shape[2], v.dtype))

        def pullback(dx: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            d_unpooled, dv, _ = convolve_back(dx)
            return arctanh_back(unpool_back(d_unpooled)), dv, -d_unpooled.sum(axis=(0, 1))

        return x, pullback

    def joined(self, of_up: Sequence[np.ndarray], of_down: Sequence[np.ndarray]) -> tuple:
        """The gradients of `parameters`, from (dw, db) of the way up and (dv, dc) of that down.

        Tied, V = W̃ and c = b: each gradient is a sum of two, dV transposed back.
        """
        (dw, db), (dv, dc) = of_up, of_down
        if self.v is not None:
            return dw, db, dv, dc
        _, transpose_back = ops.transpose_filters(self.w)
        return dw + transpose_back(dv), db + dc

    def _downwards(self) -> tuple[np.ndarray, np.ndarray]:
        if self.v is not None:
            return self.v, self.c
        return ops.transpose_filters(self.w)[0], self.b


class VariantAutoencoder:
    """`ConvAutoencoder` with another pooling or untied weights.

    Parameters
    ----------
    features, filters, taps, bound, rng, dtype
        As `ConvAutoencoder` takes them; tied, the first weights of one seed are its own.
    tied : bool
        Whether the decoder has no filters but the encoder's.
    pool : function
        `ops.max_pool` or `ops.average_pool`.

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

        up = stack()
        down = [None] * len(up) if tied else stack()
        self.layers = [VariantLayer(*both) for both in zip(up, [pool] * len(up), down, strict=True)]

    @property
    def frames_per_unit(self) -> int:
        """Frames of motion for one frame of hidden units."""
        return 2 ** len(self.layers)

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Y = Φ(X): (B, T, features) to (B, T / 2^n, D)."""
        return composed.encode(self.layers, x)

    def decode(self, y: np.ndarray) -> np.ndarray:
        """X̂ = Φ†(Y), unpooling evenly."""
        return composed.decode(self.layers, y)

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X))."""
        return self.decode(self.encode(x))

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
        loss, up, down = composed.loss_both_ways(layers, x, corrupted, alpha, first)
        return loss, [each.joined(*ways) for each, *ways in zip(layers, up, down, strict=True)]

    def thaw(self) -> VariantAutoencoder:
        """Returns self: its weights are never frozen."""
        return self
