"""X * W and Z * W̃ with one W, by the spectra of blocks or as defined, and the derivatives of both.

**By blocks.** y[t] = Σ_k x[t + k - K//2] · w[k] is computed as y = C ((A x) ∘ (G w)) with a quarter
of the arithmetic. A, G and C are the constant matrices of `numpy_cae.fast.blocks`, where they are
derived. For every block j of L frames:

    u[s, j] = Σ_n A[s, n] · x[j L + n]      the N = L + K - 1 frames that block j reads
    ŵ[s]    = Σ_k G[s, k] · w[k]
    v[s, j] = u[s, j] · ŵ[s]                ∘, a matrix product over the channels
    y[j L + t] = Σ_s C[t, s] · v[s, j]

All four are linear, so the pullback is their transposes in reverse order:

    dv[s, j] = Σ_t C[t, s] · dy[j L + t]
    dŵ[s]    = Σ_j u[s, j]ᵀ · dv[s, j]      dw[k] = Σ_s G[s, k] · dŵ[s]
    du[s, j] = dv[s, j] · ŵ[s]ᵀ             dx[j L + n] += Σ_s A[s, n] · du[s, j]

where the last line adds up the contributions of overlapping blocks to a frame that they share.
With time as the leading axis, each of these lines is a plain matrix product.

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

**Both classes** have the same methods. `forwards` goes from the frames of a layer's input to those
of its output, with W, and `backwards`, its adjoint, from the output to the input. The encoder
encodes forwards and its pullback goes backwards; the decoder decodes backwards and its pullback
goes forwards. `decodes` says which of the two is computed. The arrays that they take are made by
`new_inputs` and `new_outputs`, and are zero where the frames of a window end.

References
----------
holden2015, section 5, equation 1. S. Winograd, "Arithmetic Complexity of Computations", SIAM 1980:
every bilinear algorithm has the form C ((A x) ∘ (G w)), and no correlation of L frames and K taps
needs fewer than L + K - 1 products (this one has half more, and loses no digits in float32).
"""

from __future__ import annotations

import numpy as np

from numpy_cae.fast.blocks import LayerSizes, block_length, blocks, overlap_add, overlapping
from numpy_cae.fast.products import Memory, multiply_columns, multiply_rows, zeros
from numpy_cae.ops.convolution import unfold

BLOCK_FRAMES = 20
"""A block has at most this many frames: longer blocks save products, shorter ones need fewer rows
of ŵ. Measured on one machine, with AVX-512."""

SHORT_BLOCK_FRAMES = 10
"""The same where the windows of a batch have fewer than `FEW_FRAMES` together: the rows of ŵ, which
cost the same for one frame as for many, are then most of the time."""

FEW_FRAMES = 640
"""Frames of a layer's input, in all windows of a batch."""

ThreadMemory = tuple[Memory, Memory]
"""Memory of one thread, for all of its layers: for what is needed within a method, and for its
result until the next method of any layer of the thread begins."""


class SpectralConvolution:
    """The convolutions of one layer for all windows of a batch, by blocks.

    The threads have ŵ and the spectra in common. In the spectra the windows of a thread follow one
    another, the encoder's before the decoder's.

    Parameters
    ----------
    sizes : LayerSizes
    """

    def __init__(self, sizes: LayerSizes):
        self.sizes = sizes
        few = sizes.batch * sizes.frames < FEW_FRAMES
        longest = SHORT_BLOCK_FRAMES if few else BLOCK_FRAMES
        length, self._count = block_length(sizes.frames, longest)
        self._blocks = blocks(sizes.taps, length, np.dtype(sizes.dtype).name)
        self.products = self._blocks.products
        c = self._blocks.c
        self._c = c
        self._c_decoder = c[0::2] + c[1::2] if sizes.rate == 2 else c
        rows = 2 * self._count * sizes.batch
        self._w_hat = zeros((self.products, sizes.channels, sizes.filters), sizes.dtype)
        self._input_spectra = zeros((self.products, rows, sizes.channels), sizes.dtype)
        self._output_spectra = zeros((self.products, rows, sizes.filters), sizes.dtype)
        if sizes.training:
            self._dw_hat = zeros(self._w_hat.shape, sizes.dtype)
        self._w = np.empty((0, 0, 0))
        self._transformed: bytearray | None = None
        self._inside = slice(sizes.taps // 2, sizes.taps // 2 + sizes.frames)

    def new_inputs(self, batch: int) -> tuple[np.ndarray, np.ndarray]:
        """Zeros for frames that `forwards` takes: (T, batch, C), which the caller writes, and the
        overlapping blocks of the same memory, which `forwards` takes."""
        rows = self._count * self._blocks.frames  # at least T
        padded = zeros((rows + self.sizes.taps - 1, batch, self.sizes.channels), self.sizes.dtype)
        frames = overlapping(_as_rows(padded), self._blocks, self._count)
        return padded[self._inside], frames

    def new_outputs(self, batch: int, decodes: bool) -> tuple[np.ndarray, np.ndarray]:
        """Zeros for frames that `backwards` takes: (T, batch, D), or (T/2, batch, D) if the decoder
        unpools evenly, which the caller writes, and the memory which `backwards` takes."""
        rate = self.sizes.rate if decodes else 1
        rows = self._count * self._blocks.frames
        padded = zeros((rows // rate, batch, self.sizes.filters), self.sizes.dtype)
        return padded[: self.sizes.frames // rate], padded

    def set_filters(self, w: np.ndarray) -> bool:
        """Use W (K, C, D); return whether `transform_filters` must be called.

        ŵ of the last call stays valid if all numbers of W are those of that call. Two buffers are
        compared without the array of truth values that `np.array_equal` writes.
        """
        self._w = np.ascontiguousarray(w, self.sizes.dtype)
        if self._transformed is not None and self._transformed == self._w.data:
            return False
        self._transformed = None
        return True

    def transform_filters(self, rows: slice) -> None:
        """Compute some of the rows of ŵ, whose number is `products`."""
        w_hat = self._w_hat.reshape(1, self.products, -1)[:, rows]
        multiply_columns(self._blocks.g[rows], self._w.reshape(1, self.sizes.taps, -1), w_hat)

    def remember_filters(self) -> None:
        """Keep the numbers of W, when all of ŵ is computed; in training they change anyway."""
        if not self.sizes.training:
            self._transformed = bytearray(self._w.data)

    def forwards(
        self, frames: np.ndarray, windows: slice, decodes: bool, memory: ThreadMemory
    ) -> np.ndarray:
        """C ((A x) ∘ ŵ) of the blocks of some windows, (T or T/2, windows, D)."""
        rate = self.sizes.rate if decodes else 1
        c = self._c_decoder if decodes else self._c
        spectra = self._input_spectra[:, self._rows(windows, decodes)]
        multiply_columns(self._blocks.a, frames, self._by_block(spectra))
        product = memory[0](*spectra.shape[:2], self.sizes.filters)
        multiply_rows(spectra, self._w_hat, product)
        batch = windows.stop - windows.start
        output = memory[1](self._count * len(c), batch, self.sizes.filters)
        multiply_columns(c, self._by_block(product), self._cut(output))
        return output[: self.sizes.frames // rate]

    def transform_outputs(self, frames: np.ndarray, windows: slice, decodes: bool) -> np.ndarray:
        """Cᵀ dy or Cᵀ z of some windows, which the gradient of W needs: (S, rows, D)."""
        c = self._c_decoder if decodes else self._c
        spectra = self._output_spectra[:, self._rows(windows, decodes)]
        multiply_columns(c.T, self._cut(frames), self._by_block(spectra))
        return spectra

    def backwards(
        self, frames: np.ndarray, windows: slice, decodes: bool, memory: ThreadMemory
    ) -> np.ndarray:
        """Aᵀ ((Cᵀ z) ∘ ŵᵀ) of the frames of some windows, (T, windows, C)."""
        spectra = self.transform_outputs(frames, windows, decodes)
        frame = (windows.stop - windows.start, self.sizes.channels)
        product = memory[0](*spectra.shape[:2], self.sizes.channels)
        multiply_rows(spectra, self._w_hat.transpose(0, 2, 1), product)
        parts = memory[1](self._count * self._blocks.points, *frame)
        multiply_columns(self._blocks.a.T, self._by_block(product), self._cut(parts))
        rows = (self._count - 1) * self._blocks.frames + self._blocks.points
        output = memory[0](rows, *frame)
        overlap_add(self._cut(parts), self._blocks, _as_rows(output))
        return output[self._inside]

    def gradient(self, dw: np.ndarray, channels: slice) -> None:
        """Compute dw for some channels, when the spectra of all windows are computed."""
        inputs = self._input_spectra[..., channels].transpose(0, 2, 1)
        multiply_rows(inputs, self._output_spectra, self._dw_hat[:, channels])
        columns = slice(channels.start * self.sizes.filters, channels.stop * self.sizes.filters)
        dw_hat = self._dw_hat.reshape(1, self.products, -1)[..., columns]
        dw_columns = dw.reshape(1, self.sizes.taps, -1)[..., columns]
        multiply_columns(self._blocks.g.T, dw_hat, dw_columns)

    def _rows(self, windows: slice, decodes: bool) -> slice:
        """The rows of some windows among those of the spectra."""
        batch = windows.stop - windows.start
        start = self._count * (2 * windows.start + batch * decodes)
        return slice(start, start + self._count * batch)

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
    """The convolutions of one layer for one window, as defined.

    The methods are those of `SpectralConvolution`; `windows` is the one window, and no `memory` is
    used.

    Parameters
    ----------
    sizes : LayerSizes
        Of a batch of one window.
    """

    def __init__(self, sizes: LayerSizes):
        self.sizes = sizes
        self._w = np.empty((0, 0, 0))
        self._inside = slice(sizes.taps // 2, sizes.taps // 2 + sizes.frames)
        # x̃ and d̃x̂, and the frames dy and z that they are multiplied with in dW
        self._unfolded: dict[bool, np.ndarray] = {}
        self._outputs: dict[bool, np.ndarray] = {}

    def new_inputs(self, batch: int) -> tuple[np.ndarray, np.ndarray]:
        """Zeros for frames that `forwards` takes: (T, 1, C), which the caller writes, and the
        padded memory of these, which `forwards` takes."""
        rows = self.sizes.frames + self.sizes.taps - 1
        padded = np.zeros((rows, batch, self.sizes.channels), self.sizes.dtype)
        return padded[self._inside], padded

    def new_outputs(self, batch: int, decodes: bool) -> tuple[np.ndarray, np.ndarray]:
        """Zeros for frames that `backwards` takes: (T or T/2, 1, D), twice the same array."""
        rate = self.sizes.rate if decodes else 1
        outputs = np.zeros((self.sizes.frames // rate, batch, self.sizes.filters), self.sizes.dtype)
        return outputs, outputs

    def set_filters(self, w: np.ndarray) -> bool:
        """Use W (K, C, D), which needs no transform."""
        self._w = np.ascontiguousarray(w, self.sizes.dtype)
        return False

    def forwards(
        self, frames: np.ndarray, windows: slice, decodes: bool, memory: ThreadMemory
    ) -> np.ndarray:
        """x̃ W of padded frames, (T or T/2, 1, D)."""
        rate = self.sizes.rate if decodes else 1
        if rate == 2:
            frames = frames.copy()
            frames[:-1] += frames[1:]
        unfolded = unfold(frames.swapaxes(0, 1), len(self._w))[::rate]
        self._unfolded[decodes] = unfolded
        return (unfolded @ self._matrix())[:, None]

    def transform_outputs(self, frames: np.ndarray, windows: slice, decodes: bool) -> np.ndarray:
        """The frames dy or z, which the gradient of W needs: (T or T/2, D)."""
        self._outputs[decodes] = frames[:, 0]
        return self._outputs[decodes]

    def backwards(
        self, frames: np.ndarray, windows: slice, decodes: bool, memory: ThreadMemory
    ) -> np.ndarray:
        """fold(z Wᵀ), (T, 1, C)."""
        rate = self.sizes.rate if decodes else 1
        taps, channels = self._w.shape[:2]
        outputs = self.transform_outputs(frames, windows, decodes)
        parts = (outputs @ self._matrix().T).reshape(-1, taps, 1, channels)
        padded = np.zeros((self.sizes.frames + taps - 1, 1, channels), self.sizes.dtype)
        for k in range(taps):
            padded[k : k + self.sizes.frames : rate] += parts[:, k]
        if rate == 2:
            padded[1:] += padded[:-1]
        return padded[self._inside]

    def gradient(self, dw: np.ndarray, channels: slice) -> None:
        """Compute dw of all channels: there is one thread."""
        unfolded = np.concatenate([self._unfolded[False], self._unfolded[True]])
        outputs = np.concatenate([self._outputs[False], self._outputs[True]])
        np.matmul(unfolded.T, outputs, out=dw.reshape(-1, dw.shape[2]))

    def _matrix(self) -> np.ndarray:
        """W as (K · C, D)."""
        return self._w.reshape(-1, self._w.shape[2])


Convolution = SpectralConvolution | DirectConvolution
