"""Three constant matrices that make a convolution cheap: y = C ((A x) ∘ (G w)).

A convolution is a product of spectra. L frames of output of a filter of K taps need N = L + K - 1
frames of input: a discrete Fourier transform of N points, which at this length is computed fastest
as a product with a constant matrix.

**The transform, in real numbers.** With c_f[n] = cos(2π f n / N) and s_f[n] = sin(2π f n / N), the
spectrum of x at the frequency f is a + i b with a = Σ c_f x and b = -Σ s_f x. The filter slides
along x without being flipped (y[t] = Σ_k x[t + k] w[k], a correlation), so its spectrum enters
conjugated, as p + i q with p = Σ c_f w and q = +Σ s_f w. Their product

    (a + i b)(p + i q) = (a p - b q) + i (a q + b p)

has four real products; three are enough (Gauss):

    k1 = (a + b) p        k2 = a (q - p)        k3 = b (p + q)
    real = k1 - k3        imaginary = k1 + k2

So A has the three rows c_f - s_f, c_f and -s_f for each frequency, G the three rows c_f, s_f - c_f
and c_f + s_f, and C holds the coefficients of k1, k2 and k3 in the inverse transform. The real
frequencies (0, and N/2 where N is even) are one product each. Together that is S ≈ 3N/2 products.

**The cost.** x and w are scalars only in this derivation. With C channels in and D filters
out, each of the S products ∘ is a product of matrices over the channels: S · C · D multiplications
for L frames, where the sum over taps needs K · L · C · D. For 15 taps and blocks of 40 frames,
S = 80 instead of 600. What A, G and C cost grows with C + D, not with C · D, and is a matrix
product as well.

**The adjoint** needs no other matrices: dx = Aᵀ((Cᵀ dy) ∘ (G w)) and dw = Gᵀ((A x) ∘ (Cᵀ dy)).

`cheapest_length` chooses the cheapest form of a layer's convolution for the sizes of its
computation.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import as_strided


class Blocks(NamedTuple):
    """A, G and C for filters of K taps over blocks of L frames.

    Attributes
    ----------
    a : (S, N) array
        From N = L + K - 1 frames of input to the S values that are multiplied.
    g : (S, K) array
        From K taps to the S values that they are multiplied with.
    c : (L, S) array
        From S products to L frames of output.
    frames, points, products : int
        L, N and S.
    """

    a: np.ndarray
    g: np.ndarray
    c: np.ndarray
    frames: int
    points: int
    products: int


@lru_cache
def blocks(taps: int, frames: int, dtype: str = "float64") -> Blocks:
    """The matrices, computed in float64 and rounded to `dtype`; cached for each argument."""
    points = frames + taps - 1
    f = np.arange(points // 2 + 1)
    real = 2 * f % points == 0

    def waves(count: int) -> tuple[np.ndarray, np.ndarray]:
        """cos(2π f n / N) and sin(2π f n / N) for the first values of n, (frequencies, count)."""
        angles = (2 * np.pi * f / points)[:, None] * np.arange(count)
        return np.cos(angles), np.sin(angles)

    cos, sin = waves(points)
    a = np.stack([cos - sin, cos, -sin], axis=1)
    cos, sin = waves(taps)
    g = np.stack([cos, sin - cos, cos + sin], axis=1)
    cos, sin = waves(frames)  # y = 2 (real · cos - imaginary · sin) / N: the factor 2 is for -f
    c = np.stack([cos - sin, -sin, -cos], axis=1) * np.where(real, 1, 2)[:, None, None] / points
    needed = np.ones((len(f), 3), bool)
    needed[real, 1:] = False
    matrices = []
    for matrix in (a[needed], g[needed], c[needed].T):
        matrices.append(np.ascontiguousarray(matrix, dtype=dtype))
        matrices[-1].flags.writeable = False
    return Blocks(*matrices, frames, points, len(matrices[0]))


def block_length(frames: int, longest: int) -> tuple[int, int]:
    """L and the number of blocks for so many frames; L is even, at most `longest` (also even)."""
    count = max(1, -(-frames // longest))
    length = -(-frames // count)
    return length + length % 2, count


def overlapping(padded: np.ndarray, blocks: Blocks, count: int) -> np.ndarray:
    """The N frames of each block, a view (count, N, width) of (count · L + K - 1, width) rows."""
    frame, value = padded.strides
    shape = (count, blocks.points, padded.shape[1])
    return as_strided(padded, shape, (blocks.frames * frame, frame, value), writeable=False)


def overlap_add(parts: np.ndarray, blocks: Blocks, out: np.ndarray) -> None:
    """The adjoint of `overlapping`, into `out`: where blocks share frames, values are added."""
    out[: blocks.points] = parts[0]
    out[blocks.points :] = 0
    for block in range(1, len(parts)):
        start = block * blocks.frames
        out[start : start + blocks.points] += parts[block]


MEMORY = 5
"""To read or write a number of an array that fits no cache takes as long as this many
multiplications of a matrix product (measured)."""


@dataclass(frozen=True)
class LayerSizes:
    """K, C, D, B and T of a layer; a row of the decoder's input stands for `rate` frames.

    It is 2 where the layer unpools evenly, else 1. Without `training` no gradient is computed.
    """

    taps: int
    channels: int
    filters: int
    batch: int
    frames: int
    rate: int
    training: bool
    dtype: np.dtype


def cheapest_length(sizes: LayerSizes, windows: int, blas_threads: int) -> int:
    """Frames of a block, at most, in the cheapest form of the convolution; 1 is the direct form.

    The time is that of so many windows; the direct form is for one. BLAS shares its products
    between so many threads.
    """
    costs = {longest: cost_by_blocks(sizes, windows, longest) for longest in range(4, 65, 2)}
    if sizes.batch == 1:
        costs[1] = direct_cost(sizes) / blas_threads
    return min(costs, key=lambda longest: costs[longest])


def cost_by_blocks(sizes: LayerSizes, windows: int, longest: int) -> float:
    """Multiplications by blocks of `longest` frames at most.

    Long blocks save products, short blocks need fewer rows of ŵ, which cost the same for one window
    as for many. A step of training takes

        2 S K C D + 8 S C D · MEMORY    ŵ = G w, dw = Gᵀ dŵ, and all of ŵ or dŵ is read or written
                                        eight times
        6 S B C D per block             ∘ in encoder and decoder, their pullbacks, both gradients
        4 S N B C per block             A and Aᵀ
        3 S L B D per block             C and Cᵀ, at half the rate in the decoder

    and encoding or decoding alone, with ŵ known, takes

        (S + 2 K) C D · MEMORY          ŵ is read once, W is compared with a copy
        (S C D + S N C + S L D) B per block
    """
    length, count = block_length(sizes.frames, longest)
    points = length + sizes.taps - 1
    products = points // 2 + 1 + 2 * ((points - 1) // 2)
    area = sizes.channels * sizes.filters
    if sizes.training:
        once = (2 * sizes.taps + 8 * MEMORY) * products
        per_block = 6 * area + 4 * points * sizes.channels + 3 * length * sizes.filters
    else:
        once = MEMORY * (products + 2 * sizes.taps)
        per_block = area + points * sizes.channels + length * sizes.filters
    return once * area + count * windows * products * per_block


def direct_cost(sizes: LayerSizes) -> float:
    """Multiplications for one window in the direct form.

    A step of training has three products of T rows in the encoder and three of T / rate rows in the
    decoder; encoding has one of T rows. A row has K C D multiplications. Each product reads or
    writes W and the rows of K C numbers.
    """
    products = 6 if sizes.training else 1
    rows = 3 * (sizes.frames + sizes.frames // sizes.rate) if sizes.training else sizes.frames
    row = sizes.taps * sizes.channels
    return rows * row * (sizes.filters + MEMORY) + products * row * sizes.filters * MEMORY
