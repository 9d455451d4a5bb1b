"""The sizes of one layer's computation, and the cheapest form of its convolution for them."""

from dataclasses import dataclass

import numpy as np

from numpy_cae.fast.blocks import block_length

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
