"""The convolutional autoencoder of holden2015: tied layers between motion and its manifold.

Encoding runs layers 1…n, decoding layers n…1; the backward pass calls the pullbacks in the reverse
of that order. `fast.accelerate(model)` computes the same numbers in less time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Literal

import numpy as np

from numpy_cae import ops
from numpy_cae.models.conv_layer import ConvLayer
from numpy_cae.models.initial_filters import passing_filters
from numpy_cae.ops.shapes import require_shape

Gradients = list[tuple[np.ndarray, np.ndarray]]
"""(dw, db) of each layer, lowest first."""


class ConvAutoencoder:
    """Φ and Φ† of section 5, a stack of `ConvLayer`.

    >>> model = ConvAutoencoder(features=63, filters=(64, 128, 256), taps=15)
    >>> y = model.encode(np.zeros((1, 240, 63), np.float32))  # 8 seconds of motion
    >>> y.shape, model.decode(y).shape
    ((1, 30, 256), (1, 240, 63))

    Every method raises ValueError, naming the argument, if a shape does not fit.

    Parameters
    ----------
    features : int
        Degrees of freedom of a frame, 63 in the paper.
    filters : sequence of int
        Number of filters of each layer, lowest first.
    taps : int
        Frames that a filter covers, odd.
    bound : float
        The decoder clips the input of arctanh to ±bound: arctanh(±1) is infinite, and the layer
        above can output more than 1 (docs/lab_book/equations.md).
    rng : numpy.random.Generator, optional
        Draws the initial weights; by default a generator with seed 0.
    dtype : float32 (for training) or float64 (for checking gradients)
    initial : {"random", "passing"}
        The initial weights: those of `ConvLayer.initial`, or `passing_filters`.

    Attributes
    ----------
    layers : list of ConvLayer, lowest first

    Examples
    --------
    One step of gradient descent by hand:

    >>> x = np.random.default_rng(1).normal(size=(4, 16, 5)) / 4
    >>> model = ConvAutoencoder(5, filters=(6, 7), taps=3, dtype=np.float64)
    >>> loss, gradients = model.loss_and_gradients(x, x)
    >>> for layer, (dw, db) in zip(model.layers, gradients, strict=True):
    ...     layer.w -= 0.1 * dw
    ...     layer.b -= 0.1 * db
    >>> model.loss_and_gradients(x, x)[0] < loss
    True
    """

    def __init__(
        self,
        features: int = 63,
        filters: Sequence[int] = (64, 128, 256),
        taps: int = 15,
        bound: float = 0.9,
        rng: np.random.Generator | None = None,
        dtype: np.dtype | type = np.float32,
        initial: Literal["random", "passing"] = "random",
    ):
        _require_settings(filters, bound)
        rng = rng or np.random.default_rng(0)
        channels = (features, *filters)
        self.layers: list[ConvLayer] = []
        for below, above in pairwise(channels):
            if initial == "passing":
                w = passing_filters(taps, below, above, rng).astype(dtype)
                layer = ConvLayer(w, np.zeros(above, dtype), bound)
            else:
                layer = ConvLayer.initial(taps, below, above, bound, rng, dtype)
            self.layers.append(layer)

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """The learned arrays themselves, by name: w1, b1 (the lowest layer), w2, b2, …"""
        named: dict[str, np.ndarray] = {}
        for number, layer in enumerate(self.layers, start=1):
            named |= {f"w{number}": layer.w, f"b{number}": layer.b}
        return named

    @property
    def stride(self) -> int:
        """Input frames per hidden frame: 2**layers, 8 in the paper."""
        return 2 ** len(self.layers)

    def encode(self, x: np.ndarray, layers: int | None = None) -> np.ndarray:
        """Y = Φ(X) = Φ_n(… Φ_1(X)).

        Parameters
        ----------
        x : (B, T, features) array of float
            T is a multiple of `stride`.
        layers : int, optional
            n, the number of layers, from the lowest on; all of them by default. T is then a
            multiple of 2**n.

        Returns
        -------
        y : (B, T / 2**n, filters of layer n) array, within [-1, 1]
            Hidden units.
        """
        require_windows("x", x, self.layers[:layers])
        for layer in self.layers[:layers]:
            x, _ = layer.encode_with_pullback(x)
        return x

    def decode(self, y: np.ndarray) -> np.ndarray:
        """X̂ = Φ†(Y) = Φ_1†(… Φ_n†(Y)), unpooling evenly.

        y : (B, T / stride, filters of the top layer); returns x_hat (B, T, features).
        """
        x_hat, _ = self.decode_with_pullback(y)
        return x_hat

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)): the motion on the manifold that represents x, (B, T, features) to the same."""
        return self.decode(self.encode(x))

    def decode_with_pullback(
        self, y: np.ndarray
    ) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
        """X̂ = Φ†(Y) as `decode`, and the pullback that takes dX̂ to dY.

        Use it to optimise Y by gradient descent on a loss of X̂; the weights get no gradient. Where
        |Y| exceeds the bound of tanh⁻¹, X̂ does not depend on Y and dY is 0.

        Returns
        -------
        x_hat : (B, T, features) array
        pullback : dx_hat -> dy
        """
        require_shape("y", y, ("batch", "frames", self.layers[-1].b.size))
        x_hat, pullbacks = _decode_layers(self.layers, y, [None] * len(self.layers))

        def pullback(dx_hat: np.ndarray) -> np.ndarray:
            d = dx_hat
            for layer_pullback in reversed(pullbacks):
                d, _, _ = layer_pullback(d)
            return d

        return x_hat, pullback

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> tuple[float, Gradients]:
        """Equation 3 and its derivatives, for the whole stack or for one layer by itself.

        With Y = Φ(X_c) and X̂ = Φ†(Y), the loss is a sum of two terms,

            Loss = mean((X̂ - X)²) + α · mean(|Y|)

        and Y acts on both: on the first through X̂, on the second directly. The paper has sums over
        elements; we take means, see ops/losses.py. From the end to the start,

            dX̂ = 2 (X̂ - X) / N                         pullback of the mean squared error
            dY, decoder's shares   from dX̂              pullbacks of Φ_1†, Φ_2†, …, Φ_n†
            dY += α · sign(Y) / N_Y                     pullback of the sparsity term
            encoder's shares       from dY              pullbacks of Φ_n, …, Φ_2, Φ_1

        N is the number of elements of X, N_Y that of Y. W and b are used twice, in the encoder and
        in the decoder, so the gradient for each is the sum of two shares: dL/dW = (dL/dW through
        Φ) + (dL/dW through Φ†). X_c is data, so the gradient that Φ_1 returns for it is not used.

        Parameters
        ----------
        x : (B, T, C) array of float
            The windows to reproduce: motion, or the input of `layer`.
        corrupted : (B, T, C) array of float
            X_c.
        alpha : float
            Weight of the sparsity term.
        first : one (B, T_k, D_k) array of bool for each layer used, lowest first, optional
            Masks of `ops.unpool_random`, drawn by the caller; a layer whose mask is None, or
            every layer where `first` is None, unpools evenly.
        layer : int, optional
            Index of the one layer to train, with `x` as its input; None trains the whole stack.

        Returns
        -------
        loss : float
        gradients : list of (dw, db), one for each layer used, lowest first
        """
        layers = self.layers if layer is None else [self.layers[layer]]
        require_denoising_arguments(layers, x, corrupted, first)
        masks = [None] * len(layers) if first is None else list(first)

        y = corrupted  # (B, T, C)
        encode_pullbacks = []
        for used in layers:
            y, encode_pullback = used.encode_with_pullback(y)  # (B, T/2, 64), (B, T/4, 128), …
            encode_pullbacks.append(encode_pullback)
        x_hat, decode_pullbacks = _decode_layers(layers, y, masks)  # (B, T, C)
        error, error_pullback = ops.mean_squared_error(x_hat, x)
        sparsity, sparsity_pullback = ops.mean_absolute(y)
        loss = error + alpha * sparsity

        decoder_shares = []  # the lowest layer decodes last, so its pullback is the first
        d = error_pullback()  # (B, T, C)
        for decode_pullback in reversed(decode_pullbacks):
            d, dw, db = decode_pullback(d)  # (B, T/2, 64), (B, T/4, 128), …; dw (K, C, D), db (D,)
            decoder_shares.append((dw, db))
        gradients = []
        d = d + sparsity_pullback(alpha)  # (B, T/8, 256): both terms of the loss
        for encode_pullback in reversed(encode_pullbacks):
            d, dw, db = encode_pullback(d)  # …, (B, T/2, 64), (B, T, C)
            dw_decoder, db_decoder = decoder_shares.pop()
            gradients.append((dw + dw_decoder, db + db_decoder))
        return float(loss), gradients[::-1]


def _decode_layers(
    layers: Sequence[ConvLayer], y: np.ndarray, masks: Sequence[np.ndarray | None]
) -> tuple[np.ndarray, list[Callable]]:
    """Φ†(Y) and the pullbacks of the layers in the order of decoding, the top layer first."""
    pullbacks = []
    for layer, mask in zip(reversed(layers), reversed(masks), strict=True):
        y, pullback = layer.decode_with_pullback(y, mask)
        pullbacks.append(pullback)
    return y, pullbacks


SMALLEST_BOUND = 1e-6
"""The bound of arctanh is at least this far from 0, where nothing is decoded, and from 1, where
arctanh is infinite in float32. A model file with another bound is refused."""


def _require_settings(filters: Sequence[int], bound: float) -> None:
    """Raise ValueError, naming the argument, for numbers that no network can have."""
    if any(number < 1 for number in filters):
        raise ValueError(f"filters is {tuple(filters)}, expected 1 or more of each layer")
    if not SMALLEST_BOUND <= bound <= 1 - SMALLEST_BOUND:
        raise ValueError(f"bound is {bound}, expected {SMALLEST_BOUND:g} to {1 - SMALLEST_BOUND}")


def require_windows(name: str, x: np.ndarray, layers: Sequence[ConvLayer]) -> None:
    """Raise ValueError unless the layers can encode x."""
    require_shape(name, x, ("batch", "frames", layers[0].w.shape[1]))
    if x.shape[1] % 2 ** len(layers):
        raise ValueError(
            f"{name} has shape {x.shape}: pooling {len(layers)} times needs an even number of "
            f"frames each time, so expected a multiple of {2 ** len(layers)} frames"
        )


def require_denoising_arguments(
    layers: Sequence[ConvLayer],
    x: np.ndarray,
    corrupted: np.ndarray,
    first: Sequence[np.ndarray | None] | None,
) -> None:
    """Raise ValueError unless the arguments of `ConvAutoencoder.loss_and_gradients` fit."""
    require_windows("x", x, layers)
    require_shape("corrupted", corrupted, x.shape)
    if x.size == 0:
        raise ValueError(f"x has shape {x.shape}: there is nothing to compare")
    if first is None:
        return
    if len(first) != len(layers):
        raise ValueError(f"first has {len(first)} masks, expected {len(layers)}, one for a layer")
    batch, frames, _ = x.shape
    for k, (mask, layer) in enumerate(zip(first, layers, strict=True)):
        if mask is None:
            continue
        require_shape(f"first[{k}]", mask, (batch, frames >> (k + 1), layer.b.size))
        if np.asarray(mask).dtype != bool:
            raise ValueError(f"first[{k}] has dtype {np.asarray(mask).dtype}, expected bool")
