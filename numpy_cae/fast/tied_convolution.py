"""X * W and Z * W̃ with one W, by blocks, and the derivatives of both.

The derivation is in `numpy_cae.fast.convolution`: y = C ((A x) ∘ ŵ) with ŵ = G w. Convolving with
W̃ is the adjoint of convolving with W, so the decoder applies the transposed matrices in reverse
order, with the same ŵ:

    encoder     y = C ((A x) ∘ ŵ)           its pullback    dx = Aᵀ ((Cᵀ dy) ∘ ŵᵀ)
    decoder     x̂ = Aᵀ ((Cᵀ z) ∘ ŵᵀ)        its pullback    dz = C ((A dx̂) ∘ ŵ)

ŵ and the gradient for W are in `numpy_cae.fast.filter_spectra`.

**Even unpooling** makes pairs of equal frames, z = E h with h at half the rate. E is constant, so
it is absorbed by the constant matrix: Cᵀ z = (C₂)ᵀ h with C₂ = Eᵀ C, the sums of pairs of rows of
C. The decoder's products with C then cost half.

Time is the leading axis everywhere: a row is a frame of B windows of C channels side by side.
"""

import numpy as np

from numpy_cae.fast.blocks import block_length, overlap_add, overlapping
from numpy_cae.fast.filter_spectra import FilterSpectra, buffer
from numpy_cae.fast.products import multiply_columns, multiply_rows


def cheapest_length(
    taps: int, channels: int, filters: int, batch: int, frames: int, training: bool = True
) -> int:
    """The longest block to use: the one with the least arithmetic.

    Long blocks save products, short blocks need fewer rows of ŵ, which cost the same for one window
    as for many. In multiplications, a step of training takes

        2 S K C D + 8 · 5 S C D     ŵ = G w, dw = Gᵀ dŵ, and the memory: all of ŵ or dŵ is read or
                                    written eight times, each number as long as five multiplications
        6 S B C D per block         ∘ in encoder and decoder, their pullbacks, and both gradients
        4 S N B C per block         A and Aᵀ
        3 S L B D per block         C and Cᵀ, at half the rate in the decoder

    and encoding or decoding alone, with ŵ known, takes

        5 S C D                     the memory: ŵ is read once
        (S C D + S N C + S L D) B per block
    """

    def cost(longest: int) -> float:
        length, count = block_length(frames, longest)
        points = length + taps - 1
        products = points // 2 + 1 + 2 * ((points - 1) // 2)
        once = 2 * taps + 40 if training else 5
        mixing, analysis, synthesis = (6, 4, 3) if training else (1, 1, 1)
        per_block = (
            mixing * channels * filters
            + analysis * points * channels
            + synthesis * length * filters
        )
        return products * (once * channels * filters + count * batch * per_block)

    return min(range(4, 65, 2), key=cost)


class TiedConvolution:
    """One layer's W in the encoder and in the decoder, for one thread's windows in its buffers.

    Parameters
    ----------
    spectra : FilterSpectra
        ŵ, and where the spectra of all windows are written for the gradient of W.
    windows : slice
        The thread's part of the batch.
    frames : int
        T, the frames of the encoder's input.
    halved : bool
        The decoder's input is at half the rate, each row standing for two frames.

    Attributes
    ----------
    x : (T, B·C) view
        Input of the encoder; the caller writes it.
    z : (T, B·D) or (T/2, B·D) view
        Input of the decoder; the caller writes it.
    error : (T, B·C) view
        dx̂, the gradient for the decoder's output; the caller writes it.
    d_convolved : (T, B·D) view
        dy, the gradient for the encoder's output; the caller writes it.
    """

    def __init__(self, spectra: FilterSpectra, windows: slice, frames: int, halved: bool):
        self.spectra, self.blocks, self._count = spectra, spectra.blocks, spectra.count
        constants, count, dtype = spectra.blocks, spectra.count, spectra.w_hat.dtype
        self.a, self.c = constants.a, constants.c
        self.c_down = self.c[0::2] + self.c[1::2] if halved else self.c
        batch, taps = windows.stop - windows.start, spectra.taps
        channels, filters = spectra.channels, spectra.filters
        products, rows = constants.products, count * constants.frames
        rate = 2 if halved else 1

        def padded(width: int) -> np.ndarray:
            return buffer(rows + taps - 1, width, dtype)

        padded_x, padded_error = padded(batch * channels), padded(batch * channels)
        inside = slice(taps // 2, taps // 2 + frames)
        self.x, self.error = padded_x[inside], padded_error[inside]
        self._x_blocks = overlapping(padded_x, constants, count)
        self._error_blocks = overlapping(padded_error, constants, count)
        all_z, all_dy = (buffer(n, batch * filters, dtype) for n in (rows // rate, rows))
        self.z, self.d_convolved = all_z[: frames // rate], all_dy[:frames]
        self._z_blocks, self._dy_blocks = _cut(all_z, count), _cut(all_dy, count)

        halved_dz = buffer(rows // rate, batch * filters, dtype)
        self._outputs = {  # each with the frames that count
            "convolve": (buffer(rows, batch * filters, dtype), slice(frames)),
            "transposed": (padded(batch * channels), inside),
            "transposed pullback": (halved_dz, slice(frames // rate)),
            "convolve pullback": (padded(batch * channels), inside),
        }
        self._parts = np.empty((count, constants.points, batch * channels), dtype)

        size = count * batch
        start = 2 * count * windows.start
        encoder, decoder = slice(start, start + size), slice(start + size, start + 2 * size)
        self._ax, self._a_error = spectra.below[:, encoder], spectra.below[:, decoder]
        self._c_dy, self._cz = spectra.above[:, encoder], spectra.above[:, decoder]
        self._product_c, self._product_d = (
            buffer(products, size * width, dtype).reshape(products, size, width)
            for width in (channels, filters)
        )
        self._w_hat = spectra.w_hat.reshape(products, channels, filters)

    def convolve(self) -> np.ndarray:
        """C ((A x) ∘ ŵ) of `x`: (T, B·D)."""
        return self._forwards(self._x_blocks, self._ax, self.c, "convolve")

    def convolve_transposed(self) -> np.ndarray:
        """Aᵀ ((Cᵀ z) ∘ ŵᵀ) of `z`: (T, B·C)."""
        multiply_columns(self.c_down.T, self._z_blocks, _by_block(self._cz, self._count))
        return self._backwards(self._cz, "transposed")

    def convolve_transposed_pullback(self) -> np.ndarray:
        """dz = C ((A dx̂) ∘ ŵ) of `error`: as `z`."""
        return self._forwards(self._error_blocks, self._a_error, self.c_down, "transposed pullback")

    def convolve_pullback(self, with_dx: bool = True) -> np.ndarray | None:
        """dx = Aᵀ ((Cᵀ dy) ∘ ŵᵀ) of `d_convolved`: (T, B·C); without dx, only Cᵀ dy."""
        multiply_columns(self.c.T, self._dy_blocks, _by_block(self._c_dy, self._count))
        return self._backwards(self._c_dy, "convolve pullback") if with_dx else None

    def _forwards(
        self, blocks: np.ndarray, analysed: np.ndarray, c: np.ndarray, name: str
    ) -> np.ndarray:
        """C ((A blocks) ∘ ŵ); A blocks is kept for the gradient of the filters."""
        multiply_columns(self.a, blocks, _by_block(analysed, self._count))
        multiply_rows(analysed, self._w_hat, self._product_d)
        output, valid = self._outputs[name]
        multiply_columns(c, _by_block(self._product_d, self._count), _cut(output, self._count))
        return output[valid]

    def _backwards(self, spectra: np.ndarray, name: str) -> np.ndarray:
        """Aᵀ (spectra ∘ ŵᵀ), the overlaps added."""
        multiply_rows(spectra, self._w_hat.transpose(0, 2, 1), self._product_c)
        multiply_columns(self.a.T, _by_block(self._product_c, self._count), self._parts)
        output, valid = self._outputs[name]
        overlap_add(self._parts, self.blocks, output)
        return output[valid]


def _by_block(rows: np.ndarray, count: int) -> np.ndarray:
    """(S, count · B, width) as (count, S, B · width) for the transforms, the same memory."""
    products, size, width = rows.shape
    return rows.reshape(products, count, size // count * width).transpose(1, 0, 2)


def _cut(rows: np.ndarray, count: int) -> np.ndarray:
    """(count · n, width) as (count, n, width), the same memory."""
    return rows.reshape(count, len(rows) // count, rows.shape[1])
