"""The convolutional autoencoder of holden2015: three tied layers between motion and manifold.

What it computes is written down in `models.composed`, out of `numpy_cae.ops`. How it computes it
is `models.fast`: the same numbers, up to rounding, in a third of the time and less.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from numpy_cae.fast.network import FastNetwork
from numpy_cae.models.composed import Gradients, Objective
from numpy_cae.models.conv_layer import ConvLayer
from numpy_cae.ops.shapes import require_shape


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
        self._fast = FastNetwork()

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
        _require_windows("x", x, self.layers)
        return self._fast.encode(self.layers, x)

    def decode(self, y: np.ndarray) -> np.ndarray:
        """X̂ = Φ†(Y), unpooling evenly: hidden units (B, T/8, 256) to windows (B, T, features).

        Raises
        ------
        ValueError
            If the hidden units do not fit.
        """
        require_shape("y", y, ("batch", "frames", self.layers[-1].b.size))
        return self._fast.decode(self.layers, y)

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)): the motion on the manifold that stands for x, (B, T, features) to the same."""
        return self.decode(self.encode(x))

    def latent_gradient(self, y: np.ndarray, objective: Objective) -> tuple[float, np.ndarray]:
        """L(Φ†(Y)) and dL/dY: how to move along the manifold so that the motion suits a wish.

        Parameters
        ----------
        y : (B, T/8, 256) array of float
            Hidden units; beyond the bound of arctanh nothing changes, and dL/dY is 0.
        objective : function, X̂ (B, T, features) -> (L, dL/dX̂)
            A loss of the decoded windows and its gradient; X̂ is not to be kept.

        Returns
        -------
        loss : float
        dy : array of the shape of y
        """
        require_shape("y", y, ("batch", "frames", self.layers[-1].b.size))
        return self._fast.latent_gradient(self.layers, y, objective)

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
        _require_windows("x", x, layers)
        require_shape("corrupted", corrupted, x.shape)
        if x.size == 0:
            raise ValueError(f"x has shape {x.shape}: there is nothing to compare")
        if first is not None:
            _require_masks(first, x, layers)
        return self._fast.loss_and_gradients(layers, x, corrupted, alpha, first)

    def freeze(self) -> ConvAutoencoder:
        """Make the weights read-only, so that the filters' spectra are computed once; returns self.

        `encode`, `decode` and `project` of a single window then take about half the time. Training
        makes the weights writeable again.
        """
        for layer in self.layers:
            layer.w.flags.writeable = layer.b.flags.writeable = False
        return self

    def thaw(self) -> ConvAutoencoder:
        """Give every layer weights of its own that can be changed; returns self."""
        for layer in self.layers:
            layer.w, layer.b = layer.w.copy(), layer.b.copy()
        return self


def _require_windows(name: str, x: np.ndarray, layers: Sequence[ConvLayer]) -> None:
    require_shape(name, x, ("batch", "frames", layers[0].w.shape[1]))
    if x.shape[1] % 2 ** len(layers):
        raise ValueError(
            f"{name} has shape {x.shape}: pooling {len(layers)} times needs an even number of "
            f"frames each time, so expected a multiple of {2 ** len(layers)} frames"
        )


def _require_masks(first: Sequence[np.ndarray], x: np.ndarray, layers: Sequence[ConvLayer]) -> None:
    if len(first) != len(layers):
        raise ValueError(f"first has {len(first)} masks, expected one for each of {len(layers)}")
    batch, frames, _ = x.shape
    for k, (mask, layer) in enumerate(zip(first, layers, strict=True)):
        if mask is None:
            continue
        require_shape(f"first[{k}]", mask, (batch, frames >> (k + 1), layer.b.size))
        if np.asarray(mask).dtype != bool:
            raise ValueError(f"first[{k}] has dtype {np.asarray(mask).dtype}, expected bool")
