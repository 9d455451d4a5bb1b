"""The convolutional autoencoder of holden2015: three tied layers between motion and manifold."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from numpy_cae import ops
from numpy_cae.models.conv_layer import ConvLayer

Gradients = list[tuple[np.ndarray, np.ndarray]]


class ConvAutoencoder:
    """Φ and Φ† of section 5, a stack of `ConvLayer`.

    Parameters
    ----------
    features : int
        Degrees of freedom of a frame, 63 in the paper.
    filters : sequence of int
        Filters of each layer, lowest first.
    taps : int
        Frames that a filter sees, odd.
    bound : float
        Where the decoder's arctanh clips: see "Where equation 2 breaks" in
        lessons/papers_to_code.md.
    rng : numpy.random.Generator, optional
        For the first weights; seeded with 0 where none is given.
    dtype : float32 (for training) or float64 (for checking gradients)

    Attributes
    ----------
    layers : list of ConvLayer
    """

    def __init__(
        self,
        features: int = 63,
        filters: Sequence[int] = (64, 128, 256),
        taps: int = 15,
        bound: float = 0.9,
        rng: np.random.Generator | None = None,
        dtype: np.dtype | type = np.float32,
    ):
        rng = rng or np.random.default_rng(0)
        channels = (features, *filters)
        self.layers = [
            ConvLayer.initial(taps, below, above, bound, rng, dtype)
            for below, above in pairwise(channels)
        ]

    @property
    def frames_per_unit(self) -> int:
        """Frames of motion for one frame of hidden units; a window is a multiple of it."""
        return 2 ** len(self.layers)

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Y = Φ(X): windows (B, T, features) to hidden units (B, T/8, 256) within [-1, 1].

        Raises
        ------
        ValueError
            If the features do not fit or T is not a multiple of `frames_per_unit`.
        """
        for layer in self.layers:
            x, _ = layer.encode(x)
        return x

    def decode(self, y: np.ndarray) -> np.ndarray:
        """X̂ = Φ†(Y), unpooling evenly: hidden units (B, T/8, 256) to windows (B, T, features)."""
        for layer in reversed(self.layers):
            y, _ = layer.decode(y)
        return y

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)): the motion on the manifold that stands for x, (B, T, features) to the same."""
        return self.decode(self.encode(x))

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> tuple[float, Gradients]:
        """Equation 3 and its derivatives, for the whole stack or for one layer by itself.

            Loss = mean((X - Φ†(Φ(X_c)))²) + α · mean(|Φ(X_c)|)

        W and b stand in both directions of a layer, so each gradient is a sum of two.

        Parameters
        ----------
        x : (B, T, C) array of float
            What is to be reproduced: windows of motion, or of the layer's input.
        corrupted : (B, T, C) array of float
            X_c.
        alpha : float
            Weight of the sparsity term.
        first : one (B, T_k, D_k) array of bool for each layer used, lowest first, optional
            Masks for unpooling at random; evenly where None.
        layer : int, optional
            The one layer to use, 0 the lowest; all of them where None.

        Returns
        -------
        loss : float
        gradients : list of (dw, db), one for each layer used, lowest first

        References
        ----------
        holden2015, section 6, equation 3.
        """
        layers = self.layers if layer is None else [self.layers[layer]]
        masks = [None] * len(layers) if first is None else list(first)
        if len(masks) != len(layers):
            raise ValueError(
                f"first has {len(masks)} masks, expected one for each of {len(layers)}"
            )

        y, encode_backs = corrupted, []
        for each in layers:
            y, back = each.encode(y)
            encode_backs.append(back)
        x_hat, decode_backs = y, []
        for each, mask in zip(reversed(layers), reversed(masks), strict=True):
            x_hat, back = each.decode(x_hat, mask)
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
        gradients = [
            (dw_up + dw_down, db_up + db_down)
            for (dw_up, db_up), (dw_down, db_down) in zip(reversed(up), down, strict=True)
        ]
        return float(loss), gradients
