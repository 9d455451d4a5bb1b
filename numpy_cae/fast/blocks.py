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
    return Blocks(
        a=_constant(a[needed], dtype),
        g=_constant(g[needed], dtype),
        c=_constant(c[needed].T, dtype),
        frames=frames,
        points=points,
        products=int(needed.sum()),
    )


def _constant(matrix: np.ndarray, dtype: str) -> np.ndarray:
    """A contiguous copy that cannot be written."""
    rounded = np.ascontiguousarray(matrix, dtype=dtype)
    rounded.flags.writeable = False
    return rounded


def block_length(frames: int, longest: int) -> tuple[int, int]:
    """L and the number of blocks for this many frames; L is even, at most `longest` (also even)."""
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
