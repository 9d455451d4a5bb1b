"""Damage for training that holden2015, which only sets single values to zero, does not have.

`interpolate_missing` removes what is to be completed (`manifold.complete`) and interpolates it.
`damage_stretches` is the damage of motion files: stretches in which a chain of joints is wrong.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.training.interpolation import interpolated

MAX_STRETCH_FRAMES = 80
"""A damaged stretch has at most this many frames."""
HOLE_FRAMES = (3, 100)
"""HOLE_FRAMES: a hole has at least and at most so many frames; lengths are log-uniform."""
REMOVED = (0.2, 0.97)
"""REMOVED: the bounds of the share of values that is removed from a window."""


def interpolate_missing(
    x: np.ndarray, chains: Sequence[Sequence[int]], rng: np.random.Generator
) -> np.ndarray:
    """X_c of windows (B, T, C) in which something is missing and interpolated over time.

    In half of the windows values are removed, each by itself, with a probability from U(`REMOVED`);
    in the others there are one to three holes, each in a chain of points (`damage_stretches`) or,
    one in seven, in the whole pose. The points of a chain are interpolated relative to the point
    before them, as curves through the rotations of a rig do. Half of the windows are then partly
    corrected, X_c + s (X - X_c) with s ~ U(0, 1), since completing projects what was projected.
    """
    share = rng.uniform(*REMOVED, size=(len(x), 1, 1)).astype(x.dtype)
    known = rng.random(x.shape, dtype=np.float32) >= share
    holed = rng.random(len(x)) < 0.5
    known[holed] = True
    corrupted = interpolated(x, known)
    for window in np.flatnonzero(holed):
        for _ in range(rng.integers(1, 4)):
            _cut_hole(corrupted[window], chains, rng)
    corrected = rng.random((len(x), 1, 1), dtype=np.float32).astype(x.dtype)
    corrected[rng.random(len(x)) < 0.5] = 0
    return corrupted + corrected * (x - corrupted)


def _cut_hole(x: np.ndarray, chains: Sequence[Sequence[int]], rng: np.random.Generator) -> None:
    """Interpolate one hole of a window (T, C) in place."""
    least, most = HOLE_FRAMES
    length = min(int(least * (most / least) ** rng.random()), len(x) - 1)
    start = int(rng.integers(len(x) - length + 1))
    missing = slice(start, start + length)
    number = int(rng.integers(len(chains) + max(1, len(chains) // 6)))
    if number >= len(chains):
        x[...] = _over(x, missing)
        return
    base, *points = chains[number]
    relative = np.diff([x[:, point : point + 3] for point in (base, *points)], axis=0)
    at = x[:, base : base + 3]
    for point, values in zip(points, relative, strict=True):
        at = at + _over(values, missing)
        x[missing, point : point + 3] = at[missing]


def _over(x: np.ndarray, missing: slice) -> np.ndarray:
    """Values (T, C) interpolated over missing frames."""
    known = np.ones((1, *x.shape), dtype=bool)
    known[:, missing] = False
    return interpolated(x[None], known)[0]


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
