"""X * W and Z * W̃ with one W, by the spectra of blocks or as defined, and the derivatives of both.

**By blocks.** The derivation is in `numpy_cae.fast.convolution`: y = C ((A x) ∘ ŵ) with ŵ = G w.
Convolving with W̃ is the adjoint of convolving with W, so the decoder applies the transposed
matrices in reverse order, with the same ŵ:

    encoder     y = C ((A x) ∘ ŵ)           its pullback    dx = Aᵀ ((Cᵀ dy) ∘ ŵᵀ)
    decoder     x̂ = Aᵀ ((Cᵀ z) ∘ ŵᵀ)        its pullback    dz = C ((A dx̂) ∘ ŵ)

W is used in both, so its gradient is the sum of two, over all blocks of all windows. Side by side
they are one product:

    dŵ = [A x | A dx̂]ᵀ [Cᵀ dy | Cᵀ z]       dw = Gᵀ dŵ

Each thread writes the spectra of its own windows; then each computes dw for some channels of x.
(When each thread computed dŵ for its own windows, adding these up took a tenth of a step.)

**Even unpooling** makes pairs of equal frames, z = E h with h at half the rate. E is constant, so
it is absorbed by the constant matrix: Cᵀ z = (C₂)ᵀ h with C₂ = Eᵀ C, the sums of pairs of rows of
C. The decoder's products with C then cost half.

Time is the leading axis everywhere: a row is a frame of B windows of C channels side by side.

**As defined.** `ops.conv1d` unfolds: the K frames that a frame of the result reads, side by side,
are a row x̃ of K · C numbers, and W is a matrix (K · C, D). The decoder and the pullback for x are
the adjoint: the K parts of a row are added to the frames that they were read from ("fold").

    encoder     y = x̃ W                 its pullback    dx = fold(dy Wᵀ)
    decoder     x̂ = fold(z Wᵀ)          its pullback    dz = d̃x̂ W
    dW = x̃ᵀ dy + d̃x̂ᵀ z

One window of few frames is faster so than by blocks: ŵ has several times as many numbers as W, and
reading them takes longer than the arithmetic that they save. After even unpooling the rows of a
pair of frames are added up before the product with W (after the product with Wᵀ), which is then
computed once for both.

**A pass** is the encoder's or the decoder's convolution of a layer, either way: `forwards` from the
frames below to those above, with W, and `backwards`, its adjoint. The encoder encodes forwards and
its pullback goes backwards; the decoder decodes backwards and its pullback goes forwards.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.fast.blocks import LayerSizes, block_length, blocks, overlap_add, overlapping
from numpy_cae.fast.products import Memory, multiply_columns, multiply_rows, zeros
from numpy_cae.fast.thread_team import Part
from numpy_cae.ops.convolution import unfold

BLOCK_FRAMES = 20
"""Frames of a block, at most: longer blocks save products, shorter ones need fewer rows of ŵ."""

SHORT_BLOCK_FRAMES = 10
"""The same where the windows of a batch have fewer than `FEW_FRAMES` together: the rows of ŵ, which
cost the same for one frame as for many, are then most of the time."""

FEW_FRAMES = 640
"""Of a layer's input."""


class FilterSpectra:
    """What the threads have in common in one layer that is convolved by blocks.

    Parameters
    ----------
    sizes : LayerSizes

    Attributes
    ----------
    blocks : Blocks
        A, G and C.
    count : int
        The number of blocks in a window.
    w_hat : (S, C, D) array
        ŵ.
    copy : bytearray or None
        The numbers of the W of ŵ; None if ŵ may be that of no W. Two buffers are compared without
        the array of truth values that `np.array_equal` writes.
    below, above : (S, R, C) and (S, R, D) arrays
        [A x | A dx̂] and [Cᵀ dy | Cᵀ z], R = 2 · count · B; the windows of a thread follow one
        another.
    """

    def __init__(self, sizes: LayerSizes):
        self.sizes = sizes
        few = sizes.batch * sizes.frames < FEW_FRAMES
        longest = SHORT_BLOCK_FRAMES if few else BLOCK_FRAMES
        length, self.count = block_length(sizes.frames, longest)
        self.blocks = blocks(sizes.taps, length, np.dtype(sizes.dtype).name)
        products = self.blocks.products
        rows = 2 * self.count * sizes.batch
        self.w_hat = zeros((products, sizes.channels, sizes.filters), sizes.dtype)
        self.below = zeros((products, rows, sizes.channels), sizes.dtype)
        self.above = zeros((products, rows, sizes.filters), sizes.dtype)
        self.copy: bytearray | None = None
        if sizes.training:
            self._dw_hat = zeros(self.w_hat.shape, sizes.dtype)

    def passes(self, windows: slice, memory: tuple[Memory, Memory]) -> list[SpectralPass]:
        """The encoder's convolution and the decoder's, for some windows."""
        return [SpectralPass(self, windows, memory, decodes) for decodes in (False, True)]

    def load(self, w: np.ndarray, part: Part) -> None:
        """Compute a part of the rows of ŵ."""
        rows = part(len(self.w_hat))
        w_hat = self.w_hat.reshape(1, len(self.w_hat), -1)[:, rows]
        multiply_columns(self.blocks.g[rows], w.reshape(1, self.sizes.taps, -1), w_hat)

    def gradient(self, dw: np.ndarray, part: Part) -> None:
        """Compute dw for a part of the channels, when the spectra of all windows are known."""
        channels = part(self.sizes.channels)
        below = self.below[..., channels].transpose(0, 2, 1)
        multiply_rows(below, self.above, self._dw_hat[:, channels])
        columns = slice(channels.start * self.sizes.filters, channels.stop * self.sizes.filters)
        dw_hat = self._dw_hat.reshape(1, len(self.w_hat), -1)[..., columns]
        dw_columns = dw.reshape(1, self.sizes.taps, -1)[..., columns]
        multiply_columns(self.blocks.g.T, dw_hat, dw_columns)


class SpectralPass:
    """The encoder's or the decoder's convolution of one layer, for one thread's windows, by blocks.

    Parameters
    ----------
    spectra : FilterSpectra
        ŵ, and where the spectra of all windows are written for the gradient of W.
    windows : slice
        The thread's part of the batch.
    memory : two of Memory
        For what is needed within a method, and for its result until the next method of any layer of
        the thread begins.
    decodes : bool

    Attributes
    ----------
    below : (T, B, C) view
        x, or in the decoder dx̂, the gradient for its output; the caller writes it.
    above : (T, B, D) or (T/2, B, D) view
        dy, the gradient for the output, or in the decoder z; the caller writes it.
    """

    def __init__(
        self, spectra: FilterSpectra, windows: slice, memory: tuple[Memory, Memory], decodes: bool
    ):
        sizes = spectra.sizes
        self.spectra = spectra
        self._memory, self._other_memory = memory
        self._inside = slice(sizes.taps // 2, sizes.taps // 2 + sizes.frames)
        rate = sizes.rate if decodes else 1
        c = spectra.blocks.c
        self._c = c[0::2] + c[1::2] if rate == 2 else c
        batch = windows.stop - windows.start
        rows = spectra.count * spectra.blocks.frames  # at least T
        padded = zeros((rows + sizes.taps - 1, batch, sizes.channels), sizes.dtype)
        all_above = zeros((rows // rate, batch, sizes.filters), sizes.dtype)
        self.below = padded[self._inside]
        self.above = all_above[: sizes.frames // rate]
        self._below_blocks = overlapping(_as_rows(padded), spectra.blocks, spectra.count)
        self._above_blocks = self._cut(all_above)
        start = spectra.count * (2 * windows.start + batch * decodes)
        part = slice(start, start + spectra.count * batch)
        self._below_spectra = spectra.below[:, part]
        self._above_spectra = spectra.above[:, part]

    def forwards(self) -> np.ndarray:
        """C ((A `below`) ∘ ŵ), as `above`."""
        a = self.spectra.blocks.a
        multiply_columns(a, self._below_blocks, self._by_block(self._below_spectra))
        product = self._memory(*self._below_spectra.shape[:2], self.above.shape[2])
        multiply_rows(self._below_spectra, self.spectra.w_hat, product)
        output = self._other_memory(self.spectra.count * len(self._c), *self.above.shape[1:])
        multiply_columns(self._c, self._by_block(product), self._cut(output))
        return output[: len(self.above)]

    def backwards(self, with_result: bool = True) -> np.ndarray | None:
        """Aᵀ ((Cᵀ `above`) ∘ ŵᵀ), as `below`; without the result, only Cᵀ `above`."""
        multiply_columns(self._c.T, self._above_blocks, self._by_block(self._above_spectra))
        if not with_result:
            return None
        blocks = self.spectra.blocks
        frame = self.below.shape[1:]
        product = self._memory(*self._above_spectra.shape[:2], frame[1])
        multiply_rows(self._above_spectra, self.spectra.w_hat.transpose(0, 2, 1), product)
        parts = self._other_memory(self.spectra.count * blocks.points, *frame)
        multiply_columns(blocks.a.T, self._by_block(product), self._cut(parts))
        output = self._memory((self.spectra.count - 1) * blocks.frames + blocks.points, *frame)
        overlap_add(self._cut(parts), blocks, _as_rows(output))
        return output[self._inside]

    def _by_block(self, rows: np.ndarray) -> np.ndarray:
        """(S, count · B, width) as (count, S, B · width) for the transforms, the same memory."""
        return rows.reshape(len(rows), self.spectra.count, -1).transpose(1, 0, 2)

    def _cut(self, rows: np.ndarray) -> np.ndarray:
        """(count · n, B, width) as (count, n, B · width), the same memory."""
        return rows.reshape(self.spectra.count, len(rows) // self.spectra.count, -1)


def _as_rows(frames: np.ndarray) -> np.ndarray:
    """(T, B, C) as (T, B · C), the same memory."""
    return frames.reshape(len(frames), -1)


class DirectFilters:
    """The filters of one layer that is convolved as defined, for one window: B is 1.

    Attributes
    ----------
    w : (K, C, D) array
        W; the caller sets it.
    """

    w: np.ndarray

    def __init__(self, sizes: LayerSizes):
        self.sizes = sizes

    def passes(self, windows: slice, memory: tuple[Memory, Memory]) -> list[DirectPass]:
        """The encoder's convolution and the decoder's."""
        self._passes = [DirectPass(self, 1), DirectPass(self, self.sizes.rate)]
        return self._passes

    def gradient(self, dw: np.ndarray, part: Part) -> None:
        """Compute dw, all of it in one thread."""
        rows = np.concatenate([each.rows for each in self._passes])
        above = np.concatenate([each.above[:, 0] for each in self._passes])
        np.matmul(rows.T, above, out=dw.reshape(-1, dw.shape[2]))


class DirectPass:
    """The encoder's or the decoder's convolution of one layer, for one window, as defined.

    A row of `above` stands for `rate` frames. `below` and `above` are those of `SpectralPass`.
    """

    def __init__(self, filters: DirectFilters, rate: int):
        sizes = filters.sizes
        self._filters = filters
        self._rate = rate
        self._inside = slice(sizes.taps // 2, sizes.taps // 2 + sizes.frames)
        self._padded = np.zeros((sizes.frames + sizes.taps - 1, 1, sizes.channels), sizes.dtype)
        self.below = self._padded[self._inside]
        self.above = np.zeros((sizes.frames // rate, 1, sizes.filters), sizes.dtype)

    def forwards(self) -> np.ndarray:
        """x̃ W of `below`, as `above`."""
        padded = self._padded
        if self._rate == 2:
            padded = padded.copy()
            padded[:-1] += padded[1:]
        w = self._filters.w
        self.rows = unfold(padded.swapaxes(0, 1), len(w))[:: self._rate]
        return (self.rows @ w.reshape(-1, w.shape[2]))[:, None]

    def backwards(self, with_result: bool = True) -> np.ndarray | None:
        """fold(z Wᵀ) of `above`, the adjoint of `forwards`, as `below`."""
        if not with_result:
            return None
        w = self._filters.w
        parts = (self.above[:, 0] @ w.reshape(-1, w.shape[2]).T).reshape(-1, len(w), 1, w.shape[1])
        out = np.zeros_like(self._padded)
        for k in range(len(w)):
            out[k : k + len(self.below) : self._rate] += parts[:, k]
        if self._rate == 2:
            out[1:] += out[:-1]
        return out[self._inside]
