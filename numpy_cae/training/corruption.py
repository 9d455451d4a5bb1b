"""Damage as in motion files, stretches in which a chain of joints is wrong, for training.

It is not in holden2015, which only sets single values to zero.
"""

from collections.abc import Sequence

import numpy as np

MAX_STRETCH_FRAMES = 80
"""A damaged stretch has at most this many frames."""


def damage_stretches(
    x: np.ndarray, chains: Sequence[Sequence[int]], size: float, rng: np.random.Generator
) -> np.ndarray:
    """X_c of windows (B, T, C) with the damage of motion files: up to three stretches in a window.

    In a stretch of 1 to `MAX_STRETCH_FRAMES` frames one chain of points is zeroed, frozen, frozen
    relative to its base, interpolated or displaced. The length is log-uniform: 1 to 8 frames are as
    likely as 9 to 80.

    A chain is a tuple of points, base first; each is given by the index c of its x (y and z are
    c + 1 and c + 2). The base is not damaged. A chain's last point is displaced by `size` · 2u · n,
    where u ~ U(0, 1) and n is a vector of three standard normal numbers; point k of K is displaced
    by k / K of that.
    """
    damaged = x.copy()
    frames = x.shape[1]
    for window in damaged:
        for _ in range(rng.integers(4)):
            chain = chains[int(rng.integers(len(chains)))]
            length = min(int(MAX_STRETCH_FRAMES ** rng.random()), frames)
            start = int(rng.integers(frames - length + 1))
            _damage(window, chain, slice(start, start + length), size, rng)
    return damaged


def _damage(
    x: np.ndarray, chain: Sequence[int], where: slice, size: float, rng: np.random.Generator
) -> None:
    """Damage some frames of one window (T, C) in place."""
    base, *points = chain
    before = max(where.start - 1, 0)
    after = min(where.stop, len(x) - 1)
    kind = rng.integers(5)
    shift = size * rng.standard_normal(3) * rng.random() * 2
    t = np.linspace(0, 1, where.stop - where.start + 2)[1:-1, None]
    for number, point in enumerate(points, start=1):
        value = x[where, point : point + 3]
        first = x[before, point : point + 3]
        last = x[after, point : point + 3]
        if kind == 0:
            value[...] = 0
        elif kind == 1:
            value[...] = first.copy()
        elif kind == 2:
            at_base = x[:, base : base + 3]
            value[...] = at_base[where] + (first - at_base[before])
        elif kind == 3:
            value[...] = (1 - t) * first + t * last
        else:
            value += (shift * number / len(points)).astype(x.dtype)
