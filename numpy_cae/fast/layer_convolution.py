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

One window is faster so than by blocks in a step of training, and in the
layer with the most filters otherwise: ŵ has several times as many numbers as W, and reading them
takes longer than the arithmetic that they save.

After even unpooling the rows of a pair of frames are added up before the
product with W (after the product with Wᵀ), which is then computed once for both.
"""

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


class SpectralConvolution:
    """One layer's W in the encoder and in the decoder, for one thread's windows, by blocks.

    Parameters
    ----------
    spectra : FilterSpectra
        ŵ, and where the spectra of all windows are written for the gradient of W.
    windows : slice
        The thread's part of the batch.
    memory : two of Memory
        For what is needed within a method, and for its result until the next method of any layer of
        the thread begins.

    Attributes
    ----------
    x : (T, B, C) view
        Input of the encoder; the caller writes it.
    z : (T, B, D) or (T/2, B, D) view
        Input of the decoder; the caller writes it.
    error : (T, B, C) view
        dx̂, the gradient for the decoder's output; the caller writes it.
    d_convolved : (T, B, D) view
        dy, the gradient for the encoder's output; the caller writes it.
    """

    def __init__(self, spectra: FilterSpectra, windows: slice, memory: tuple[Memory, Memory]):
        sizes = spectra.sizes
        self.spectra = spectra
        self.blocks = spectra.blocks
        self._count = spectra.count
        self._memory, self._other_memory = memory
        self._inside = slice(sizes.taps // 2, sizes.taps // 2 + sizes.frames)
        c = spectra.blocks.c
        self._c_down = c[0::2] + c[1::2] if sizes.rate == 2 else c

        batch = windows.stop - windows.start
        rows = spectra.count * spectra.blocks.frames  # at least T
        padded_x = zeros((rows + sizes.taps - 1, batch, sizes.channels), sizes.dtype)
        padded_error = zeros(padded_x.shape, sizes.dtype)
        all_z = zeros((rows // sizes.rate, batch, sizes.filters), sizes.dtype)
        all_dy = zeros((rows, batch, sizes.filters), sizes.dtype)
        self.x = padded_x[self._inside]
        self.error = padded_error[self._inside]
        self.z = all_z[: sizes.frames // sizes.rate]
        self.d_convolved = all_dy[: sizes.frames]
        self._x_blocks = overlapping(_as_rows(padded_x), spectra.blocks, spectra.count)
        self._error_blocks = overlapping(_as_rows(padded_error), spectra.blocks, spectra.count)
        self._z_blocks = self._cut(all_z)
        self._dy_blocks = self._cut(all_dy)

        size = spectra.count * batch
        start = 2 * spectra.count * windows.start
        encoder = slice(start, start + size)
        decoder = slice(start + size, start + 2 * size)
        self._ax = spectra.below[:, encoder]
        self._a_error = spectra.below[:, decoder]
        self._c_dy = spectra.above[:, encoder]
        self._cz = spectra.above[:, decoder]

    def convolve(self) -> np.ndarray:
        """C ((A x) ∘ ŵ) of `x`: (T, B, D)."""
        return self._forwards(self._x_blocks, self._ax, self.blocks.c, self.d_convolved)

    def convolve_transposed(self) -> np.ndarray:
        """Aᵀ ((Cᵀ z) ∘ ŵᵀ) of `z`: (T, B, C)."""
        multiply_columns(self._c_down.T, self._z_blocks, self._by_block(self._cz))
        return self._backwards(self._cz)

    def convolve_transposed_pullback(self) -> np.ndarray:
        """dz = C ((A dx̂) ∘ ŵ) of `error`: as `z`."""
        return self._forwards(self._error_blocks, self._a_error, self._c_down, self.z)

    def convolve_pullback(self, with_dx: bool = True) -> np.ndarray | None:
        """dx = Aᵀ ((Cᵀ dy) ∘ ŵᵀ) of `d_convolved`: (T, B, C); without dx, only Cᵀ dy."""
        multiply_columns(self.blocks.c.T, self._dy_blocks, self._by_block(self._c_dy))
        return self._backwards(self._c_dy) if with_dx else None

    def _forwards(
        self, blocks: np.ndarray, analysed: np.ndarray, c: np.ndarray, like: np.ndarray
    ) -> np.ndarray:
        """C ((A blocks) ∘ ŵ), as many rows as `like`; A blocks is kept for the gradient of W."""
        multiply_columns(self.blocks.a, blocks, self._by_block(analysed))
        product = self._memory(*analysed.shape[:2], like.shape[2])
        multiply_rows(analysed, self.spectra.w_hat, product)
        output = self._other_memory(self._count * len(c), *like.shape[1:])
        multiply_columns(c, self._by_block(product), self._cut(output))
        return output[: len(like)]

    def _backwards(self, spectra: np.ndarray) -> np.ndarray:
        """Aᵀ (spectra ∘ ŵᵀ), the overlaps added."""
        _, batch, channels = self.x.shape
        points = self.blocks.points
        product = self._memory(*spectra.shape[:2], channels)
        multiply_rows(spectra, self.spectra.w_hat.transpose(0, 2, 1), product)
        parts = self._other_memory(self._count * points, batch, channels)
        multiply_columns(self.blocks.a.T, self._by_block(product), self._cut(parts))
        output = self._memory((self._count - 1) * self.blocks.frames + points, batch, channels)
        overlap_add(self._cut(parts), self.blocks, _as_rows(output))
        return output[self._inside]

    def _by_block(self, rows: np.ndarray) -> np.ndarray:
        """(S, count · B, width) as (count, S, B · width) for the transforms, the same memory."""
        return rows.reshape(len(rows), self._count, -1).transpose(1, 0, 2)

    def _cut(self, rows: np.ndarray) -> np.ndarray:
        """(count · n, B, width) as (count, n, B · width), the same memory."""
        return rows.reshape(self._count, len(rows) // self._count, -1)


def _as_rows(frames: np.ndarray) -> np.ndarray:
    """(T, B, C) as (T, B · C), the same memory."""
    return frames.reshape(len(frames), -1)


class DirectConvolution:
    """One layer's W in the encoder and in the decoder, for one window: B is 1.

    Attributes
    ----------
    w : (K, C, D) array
        W; the caller sets it.
    x, z, error, d_convolved : arrays
        As those of `SpectralConvolution`.
    """

    def __init__(self, sizes: LayerSizes):
        self.sizes = sizes
        frames = sizes.frames
        self._inside = slice(sizes.taps // 2, sizes.taps // 2 + frames)
        self._padded_x = np.zeros((frames + sizes.taps - 1, 1, sizes.channels), sizes.dtype)
        self._padded_error = np.zeros_like(self._padded_x)
        self.x = self._padded_x[self._inside]
        self.error = self._padded_error[self._inside]
        self._dy_and_z = np.zeros((frames + frames // sizes.rate, 1, sizes.filters), sizes.dtype)
        self.d_convolved = self._dy_and_z[:frames]
        self.z = self._dy_and_z[frames:]
        self.w = np.zeros((sizes.taps, sizes.channels, sizes.filters), sizes.dtype)

    def convolve(self) -> np.ndarray:
        """x̃ W of `x`: (T, 1, D)."""
        self._x_rows = unfold(self._padded_x.swapaxes(0, 1), self.sizes.taps)
        return (self._x_rows @ self._matrix)[:, None]

    def convolve_transposed(self) -> np.ndarray:
        """fold(z Wᵀ) of `z`: (T, 1, C)."""
        return self._fold(self.z, self.sizes.rate)

    def convolve_transposed_pullback(self) -> np.ndarray:
        """dz = d̃x̂ W of `error`: as `z`."""
        padded = self._padded_error
        if self.sizes.rate == 2:
            padded = padded.copy()
            padded[:-1] += padded[1:]
        self._error_rows = unfold(padded.swapaxes(0, 1), self.sizes.taps)[:: self.sizes.rate]
        return (self._error_rows @ self._matrix)[:, None]

    def convolve_pullback(self, with_dx: bool = True) -> np.ndarray | None:
        """dx = fold(dy Wᵀ) of `d_convolved`: (T, 1, C); nothing without dx."""
        return self._fold(self.d_convolved, 1) if with_dx else None

    def gradient(self, dw: np.ndarray, part: Part) -> None:
        """Compute dw, all of it in one thread."""
        rows = np.concatenate([self._x_rows, self._error_rows])
        np.matmul(rows.T, self._dy_and_z[:, 0], out=dw.reshape(-1, dw.shape[2]))

    @property
    def _matrix(self) -> np.ndarray:
        return self.w.reshape(-1, self.sizes.filters)

    def _fold(self, rows: np.ndarray, step: int) -> np.ndarray:
        """The adjoint of unfolding, for every `step`-th frame and the one after it, and of W."""
        parts = (rows[:, 0] @ self._matrix.T).reshape(len(rows), self.sizes.taps, 1, -1)
        out = np.zeros_like(self._padded_x)
        for k in range(self.sizes.taps):
            out[k : k + len(rows) * step : step] += parts[:, k]
        if step == 2:
            out[1:] += out[:-1]
        return out[self._inside]
