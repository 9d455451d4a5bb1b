"""ŵ = G w of one layer, and its pullback, dw = Gᵀ dŵ, for the windows of all threads.

The derivation is in `numpy_cae.fast.convolution` and `numpy_cae.fast.tied_convolution`. W is used
in the encoder and in the decoder, so its gradient is the sum of two, over all blocks of all
windows. Side by side they are one product:

    dŵ = [A x | A dx̂]ᵀ [Cᵀ dy | Cᵀ z]

Each thread writes the spectra of its own windows; then each computes dw for some channels of x.
(When each thread computed dŵ for its own windows, adding these up took a tenth of a step.)
"""

import numpy as np

from numpy_cae.fast.blocks import block_length, blocks
from numpy_cae.fast.products import multiply_columns, multiply_rows

ROW_PADDING = 16
"""Floats added to each row of a buffer. Rows whose distance is a power of two are mapped to the
same lines of the cache, and a product along the columns then takes a quarter longer."""


def buffer(rows: int, width: int, dtype: np.dtype) -> np.ndarray:
    """Zeros (rows, width) whose rows are not a power of two apart."""
    return np.zeros((rows, width + ROW_PADDING), dtype)[:, :width]


class FilterSpectra:
    """What the threads have in common in one layer.

    Parameters
    ----------
    shape : (K, C, D)
        Shape of W.
    batch, frames : int
        Size of the encoder's input.
    longest : int
        Frames of a block, at most.
    dtype : dtype

    Attributes
    ----------
    blocks : Blocks
        A, G and C.
    count : int
        The number of blocks in a window.
    w_hat : (S, C·D) array
        ŵ.
    below, above : (S, 2 · count · B, C) and (S, 2 · count · B, D) arrays
        [A x | A dx̂] and [Cᵀ dy | Cᵀ z]; the windows of a thread follow one another.
    """

    def __init__(
        self, shape: tuple[int, int, int], batch: int, frames: int, longest: int, dtype: np.dtype
    ):
        self.taps, self.channels, self.filters = taps, channels, filters = shape
        length, self.count = block_length(frames, longest)
        self.blocks = blocks(taps, length, np.dtype(dtype).name)
        products, rows = self.blocks.products, 2 * self.count * batch
        self.w_hat, self._dw_hat = (buffer(products, channels * filters, dtype) for _ in "wd")
        self.below, self.above = (
            buffer(products, rows * width, dtype).reshape(products, rows, width)
            for width in (channels, filters)
        )

    def transform(self, w: np.ndarray, rows: slice) -> None:
        """Compute some rows of ŵ = G w; where w has fewer than C channels, ŵ of the rest is 0."""
        w_hat = self.w_hat[None, rows, : w[0].size]
        multiply_columns(self.blocks.g[rows], w.reshape(1, self.taps, -1), w_hat)

    def gradient(self, channels: slice, dw: np.ndarray) -> None:
        """Compute dw[:, channels], when the spectra of all windows are known."""
        dw_hat = self._dw_hat.reshape(-1, self.channels, self.filters)[:, channels]
        multiply_rows(self.below[..., channels].transpose(0, 2, 1), self.above, dw_hat)
        columns = slice(channels.start * self.filters, channels.stop * self.filters)
        dw_columns = dw.reshape(1, self.taps, -1)[..., columns]
        used = self._dw_hat[None, :, columns][..., : dw_columns.shape[-1]]
        multiply_columns(self.blocks.g.T, used, dw_columns)
