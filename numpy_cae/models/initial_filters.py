"""Initial filters of holden2015's layers that let motion pass; the paper has random ones."""

import numpy as np

WIDTH = 1.0
"""s of `passing_filters`, in frames (docs/lab_book/other_sources.md)."""


def passing_filters(taps: int, channels: int, filters: int, rng: np.random.Generator) -> np.ndarray:
    """Filters that let slow motion pass: decoding returns nearly what was encoded.

        W[k] = g(k) Q,   g(k) ∝ exp(-k² / 2s²),   Σ_k g(k) = √2,   Q: (C, D), Q Qᵀ = I

    If a motion x hardly changes in a pair of frames, the encoder passes √2 xQ to both
    frames, pooling keeps one, the decoder puts half of it on each frame and returns
    ½ · √2 · √2 · x Q Qᵀ = x. Q is random. If there are twice as many filters as channels, the
    second half of the filters has the slope, g'(k), with Σ_k |g'(k)| = √2, so that a pair of
    frames is described by its value and its slope. If there are fewer filters than channels,
    Q Qᵀ is a projection.

    Not in the paper. Such weights represent motions of every source before any training
    (docs/lab_book/other_sources.md).

    Examples
    --------
    >>> from numpy_cae.models import ConvLayer
    >>> w = passing_filters(15, 3, 6, np.random.default_rng(0))
    >>> layer = ConvLayer(w, np.zeros(6), bound=0.9)
    >>> x = 0.1 * np.sin(np.arange(160) / 10)[None, :, None] * [1.0, 2.0, -1.0]
    >>> decoded = layer.decode_with_pullback(layer.encode_with_pullback(x)[0])[0]
    >>> bool(abs(decoded - x)[:, 8:-8].max() < 0.1 * abs(x).max())
    True
    """
    k = np.arange(taps) - taps // 2
    value = np.exp(-((k / WIDTH) ** 2) / 2)
    kernels = [value / value.sum()]
    if taps > 1 and filters >= 2 * channels:
        slope = -k * value
        kernels.append(slope / np.abs(slope).sum())
    counts = [filters]
    if len(kernels) == 2:
        counts = [filters // 2, filters - filters // 2]
    banks = []
    for kernel, count in zip(kernels, counts, strict=True):
        banks.append(np.sqrt(2) * kernel[:, None, None] * _orthogonal(channels, count, rng))
    return np.concatenate(banks, axis=2)


def _orthogonal(rows: int, columns: int, rng: np.random.Generator) -> np.ndarray:
    """A random (rows, columns) array whose rows, or columns if these are fewer, are orthonormal."""
    size = max(rows, columns)
    return np.linalg.qr(rng.standard_normal((size, size)))[0][:rows, :columns]
