"""One thread's windows through all layers and back."""

from collections.abc import Sequence

import numpy as np

from numpy_cae.fast.direct_convolution import DirectConvolution
from numpy_cae.fast.fast_layer import FastLayer
from numpy_cae.fast.products import Memory, zeros
from numpy_cae.fast.spectral_convolution import FilterSpectra, SpectralConvolution

Filters = DirectConvolution | FilterSpectra


class Worker:
    """The buffers of one thread for its `windows` of a batch of B; b of them.

    Arguments and results are those of the thread's windows, in the order of the definition,
    (b, T, C); a result is valid until the next call.

    Attributes
    ----------
    layers : list of FastLayer
    loss : float
        The thread's part of the loss.
    """

    def __init__(
        self, windows: slice, filters: Sequence[Filters], bounds: Sequence[float], channels: int
    ):
        self.windows = windows
        sizes = filters[-1].sizes
        batch = windows.stop - windows.start
        self._top = zeros((sizes.frames // 2, batch, sizes.filters), sizes.dtype)
        memory = Memory(sizes.dtype), Memory(sizes.dtype)
        convolutions = [
            SpectralConvolution(each, windows, memory) if isinstance(each, FilterSpectra) else each
            for each in filters
        ]
        outputs = [above.x for above in convolutions[1:]] + [self._top]
        self.layers = [
            FastLayer(convolution, bound, output, sizes.training)
            for convolution, bound, output in zip(convolutions, bounds, outputs, strict=True)
        ]
        self.loss = 0.0
        self._batch = sizes.batch
        self._channels = channels  # without those that only fill cache lines
        self._d_top = zeros(self._top.shape, sizes.dtype)
        self._y = self._top.transpose(1, 0, 2)
        self._x = self._windows(convolutions[0].x)
        self._error = self._windows(convolutions[0].error)

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Φ(x), (b, t, D)."""
        self._x[...] = x
        for layer in self.layers:
            layer.encode()
        return self._y

    def decode(self, y: np.ndarray) -> np.ndarray:
        """Φ†(y), (b, T, C), unpooling evenly."""
        self._y[...] = y
        return self._windows(self._decode([None] * len(self.layers)))

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(x))."""
        self.encode(x)
        return self._windows(self._decode([None] * len(self.layers)))

    def pull_back(
        self, x: np.ndarray, corrupted: np.ndarray, alpha: float, first: Sequence[np.ndarray | None]
    ) -> None:
        """`loss` of equation 3, whose means are over the whole batch, and its derivatives.

        Those for the filters are not computed, but all that they are computed from.
        """
        self.encode(corrupted)
        decoded = self._decode(first)
        np.subtract(self._windows(decoded), x, out=self._error)
        error = self.layers[0].convolution.error
        elements = self._batch * x[0].size
        self.loss = float(np.multiply(error, error, out=decoded).sum()) / elements
        error *= 2 / elements

        above = [layer.convolution.error for layer in self.layers[1:]] + [self._d_top]
        for layer, dy in zip(self.layers, above, strict=True):  # dy is dx̂ of the layer above
            layer.decode_pullback(dy)
        if alpha:
            weight = alpha / (self._batch * self._y[0].size)
            self.loss += weight * float(np.abs(self._top).sum())
            self._d_top += weight * np.sign(self._top)
        d: np.ndarray | None = self._d_top
        for layer in reversed(self.layers):
            if d is not None:
                d = layer.encode_pullback(d, with_dx=layer is not self.layers[0])

    def _decode(self, first: Sequence[np.ndarray | None]) -> np.ndarray:
        """Φ† of the hidden units, (T, b, C)."""
        decoded = self._top
        for layer, mask in reversed(list(zip(self.layers, first, strict=True))):
            decoded = layer.decode(decoded, mask)
        return decoded

    def _windows(self, rows: np.ndarray) -> np.ndarray:
        """(T, b, C or more) as (b, T, C), the same memory."""
        return rows[..., : self._channels].transpose(1, 0, 2)
