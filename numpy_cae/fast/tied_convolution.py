"""X * W and Z * W̃ with one W, by blocks, and the derivatives of both.

The derivation is in `numpy_cae.fast.convolution`: y = C ((A x) ∘ ŵ) with ŵ = G w. Convolving with W̃ is the
adjoint of convolving with W, so the decoder is the transposed matrices in reverse order, with the
same ŵ:

    encoder     y = C ((A x) ∘ ŵ)           its pullback    dx = Aᵀ ((Cᵀ dy) ∘ ŵᵀ)
    decoder     x̂ = Aᵀ ((Cᵀ z) ∘ ŵᵀ)        its pullback    dz = C ((A dx̂) ∘ ŵ)

W stands in both, and its gradient is the sum of two. Written side by side they are one product:

    dw = Gᵀ ([A x | A dx̂]ᵀ [Cᵀ dy | Cᵀ z])

**Even unpooling** makes pairs of equal frames, z = E h with h at half the rate. E is constant, so
it goes into the constant matrix: Cᵀ z = (C₂)ᵀ h with C₂ = Eᵀ C, the sums of pairs of rows of C. The
decoder's side of C then costs half.

Time is the leading axis everywhere: rows are frames, B windows of C channels side by side in each.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.fast.blocks import block_length, blocks, overlap_add, overlapping
from numpy_cae.fast.products import multiply_columns, multiply_rows

SPARE = 16
"""Floats added to each row of a buffer. Rows whose distance is a power of two fall into the same
lines of the cache, and a product down the columns then takes a quarter longer."""


def buffer(rows: int, width: int, dtype: np.dtype) -> np.ndarray:
    """Zeros (rows, width), whose rows do not lie a power of two apart."""
    return np.zeros((rows, width + SPARE), dtype)[:, :width]


def cheapest_length(
    taps: int, channels: int, filters: int, batch: int, frames: int, training: bool = True
) -> int:
    """The longest block to use: the one with the least arithmetic.

    Long blocks save products, short blocks need fewer rows of ŵ, which cost the same for one window
    as for many. In multiplications, each way of a step of training counted:

        2 S K C D + 8 · 5 S C D     ŵ = G w, dw = Gᵀ dŵ, and the memory: all of ŵ or dŵ is read or
                                    written eight times, each number as long as five multiplications
        6 S B C D a block           ∘ up, down, back through both, and both gradients
        4 S N B C a block           A and Aᵀ
        3 S L B D a block           C and Cᵀ, at half the rate in the decoder

    and up or down alone, with ŵ known, which is then read once by products that keep the
    processor busier:

        5 S C D                     the memory
        (S C D + S N C + S L D) B a block
    """

    def cost(longest: int) -> float:
        length, count = block_length(frames, longest)
        points = length + taps - 1
        products = points // 2 + 1 + 2 * ((points - 1) // 2)
        once = 2 * taps + 40 if training else 5
        mixing, analysis, synthesis = (6, 4, 3) if training else (1, 1, 1)
        a_block = (
            mixing * channels * filters
            + analysis * points * channels
            + synthesis * length * filters
        )
        return products * (once * channels * filters + count * batch * a_block)

    return min(range(4, 65, 2), key=cost)


class TiedConvolution:
    """One layer's W applied upwards and downwards to one member's share, in its own buffers.

    Parameters
    ----------
    shape : (K, C, D)
        Of W.
    batch, frames : int
        Of the encoder's input.
    longest : int
        Frames of the longest block.
    dtype : dtype
    halved : bool
        The decoder's input is at half the rate, each row standing for two frames.

    Attributes
    ----------
    x : (T, B·C) view
        Input of the encoder, to be written into.
    z : (T, B·D) or (T/2, B·D) view
        Input of the decoder, to be written into.
    error : (T, B·C) view
        dx̂, the gradient for the decoder's output, to be written into.
    d_convolved : (T, B·D) view
        dy, the gradient for the encoder's output, to be written into.
    w_hat, dw_hat : (S, C·D) arrays
        ŵ and the gradient for it.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        batch: int,
        frames: int,
        longest: int,
        dtype: np.dtype,
        halved: bool,
    ):
        taps, channels, filters = shape
        length, count = block_length(frames, longest)
        self.blocks = constants = blocks(taps, length, np.dtype(dtype).name)
        self.a, self.g, self.c = constants.a, constants.g, constants.c
        self.c_down = self.c[0::2] + self.c[1::2] if halved else self.c
        products, rows = len(self.a), count * length
        rate = 2 if halved else 1

        def whole(width: int) -> np.ndarray:
            return buffer(rows + taps - 1, width, dtype)

        padded_x, padded_error = whole(batch * channels), whole(batch * channels)
        inside = slice(taps // 2, taps // 2 + frames)
        self.x, self.error = padded_x[inside], padded_error[inside]
        self._x_blocks = overlapping(padded_x, constants, count)
        self._error_blocks = overlapping(padded_error, constants, count)
        all_z, all_dy = (buffer(n, batch * filters, dtype) for n in (rows // rate, rows))
        self.z, self.d_convolved = all_z[: frames // rate], all_dy[:frames]
        self._z_blocks, self._dy_blocks = _cut(all_z, count), _cut(all_dy, count)

        self._outputs = {
            "up": buffer(rows, batch * filters, dtype),
            "down": whole(batch * channels),
            "down back": buffer(rows // rate, batch * filters, dtype),
            "up back": whole(batch * channels),
        }
        self._valid = {
            "up": slice(0, frames),
            "down": inside,
            "down back": slice(0, frames // rate),
            "up back": inside,
        }
        self._parts = np.empty((count, constants.points, batch * channels), dtype)

        size = count * batch
        beside_c, beside_d = (
            buffer(products, 2 * size * width, dtype).reshape(products, 2 * size, width)
            for width in (channels, filters)
        )
        self._ax, self._a_error = beside_c[:, :size], beside_c[:, size:]
        self._c_dy, self._cz = beside_d[:, :size], beside_d[:, size:]
        self._beside = beside_c.transpose(0, 2, 1), beside_d
        self._product_c, self._product_d = (
            buffer(products, size * width, dtype).reshape(products, size, width)
            for width in (channels, filters)
        )
        self._count = count
        self.w_hat, self.dw_hat = (buffer(products, channels * filters, dtype) for _ in "wd")
        self.shape = products, channels, filters

    def share_spectrum(self, peers: list[TiedConvolution]) -> None:
        """Use the first member's ŵ: members with windows of their own have W in common."""
        self.w_hat = peers[0].w_hat

    def transform_filters(self, w: np.ndarray, rows: slice) -> None:
        """Some rows of ŵ = G w."""
        multiply_columns(self.g[rows], w.reshape(1, len(w), -1), self.w_hat[None, rows])

    def filters_gradient(self) -> None:
        """dŵ of both directions, when all four have been called."""
        multiply_rows(*self._beside, self.dw_hat.reshape(self.shape))

    def up(self) -> np.ndarray:
        """C ((A x) ∘ ŵ) of `x`: (T, B·D)."""
        return self._forwards(self._x_blocks, self._ax, self.c, "up")

    def down(self) -> np.ndarray:
        """Aᵀ ((Cᵀ z) ∘ ŵᵀ) of `z`: (T, B·C)."""
        multiply_columns(self.c_down.T, self._z_blocks, _by_block(self._cz, self._count))
        return self._backwards(self._cz, "down")

    def down_back(self) -> np.ndarray:
        """dz = C ((A dx̂) ∘ ŵ) of `error`: as `z`."""
        return self._forwards(self._error_blocks, self._a_error, self.c_down, "down back")

    def up_back(self, wanted: bool = True) -> np.ndarray | None:
        """dx = Aᵀ ((Cᵀ dy) ∘ ŵᵀ) of `d_convolved`: (T, B·C). Where it is not wanted, only Cᵀ dy."""
        multiply_columns(self.c.T, self._dy_blocks, _by_block(self._c_dy, self._count))
        return self._backwards(self._c_dy, "up back") if wanted else None

    def _forwards(
        self, blocks: np.ndarray, analysed: np.ndarray, c: np.ndarray, name: str
    ) -> np.ndarray:
        """C ((A blocks) ∘ ŵ); A blocks is kept for the gradient of the filters."""
        multiply_columns(self.a, blocks, _by_block(analysed, self._count))
        multiply_rows(analysed, self.w_hat.reshape(self.shape), self._product_d)
        multiply_columns(
            c, _by_block(self._product_d, self._count), _cut(self._outputs[name], self._count)
        )
        return self._outputs[name][self._valid[name]]

    def _backwards(self, spectra: np.ndarray, name: str) -> np.ndarray:
        """Aᵀ (spectra ∘ ŵᵀ), the overlaps added."""
        w_hat = self.w_hat.reshape(self.shape).transpose(0, 2, 1)
        multiply_rows(spectra, w_hat, self._product_c)
        multiply_columns(self.a.T, _by_block(self._product_c, self._count), self._parts)
        overlap_add(self._parts, self.blocks, self._outputs[name])
        return self._outputs[name][self._valid[name]]


def _by_block(rows: np.ndarray, count: int) -> np.ndarray:
    """(S, count · B, width) as the transforms see it: (count, S, B · width), the same memory."""
    products, size, width = rows.shape
    return rows.reshape(products, count, size // count * width).transpose(1, 0, 2)


def _cut(rows: np.ndarray, count: int) -> np.ndarray:
    """(count · n, width) as (count, n, width), the same memory."""
    return rows.reshape(count, len(rows) // count, rows.shape[1])
