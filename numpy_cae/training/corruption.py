"""What is random in a step of holden2015's training: the corruption, and where a layer unpools."""

from collections.abc import Sequence

import numpy as np

from numpy_cae.training.schedule import Stage

MAX_STRETCH_FRAMES = 80
"""A damaged stretch has at most this many frames."""


def corrupted_copy(x: np.ndarray, stage: Stage, rng: np.random.Generator) -> np.ndarray:
    """X_c of a batch of windows (B, T, C), with all the corruption of a stage of training.

        X_c = zero_values(X, p),   p ~ U(zeroed),   and where rescaled   X_c / (1 - p)

    `stage.zeroed` is p, or the two numbers between which each window's p is drawn; below 1 if
    `stage.rescaled`. Zeroing values with probability p multiplies their expected sum by 1 - p.
    Dividing by 1 - p restores the sum for every p, so the filters are not fitted to one p.
    """
    p: float | np.ndarray
    if isinstance(stage.zeroed, tuple):
        p = rng.uniform(*stage.zeroed, size=(len(x), 1, 1)).astype(x.dtype)
    else:
        p = stage.zeroed
    corrupted = zero_values(x, p, rng)
    if stage.rescaled:
        corrupted = corrupted / (1 - p)
    if stage.displacement:
        corrupted = damage_stretches(corrupted, stage.chains, stage.displacement, rng)
    if stage.noise:
        deviation = stage.noise * rng.random((len(x), 1, 1), dtype=x.dtype)
        corrupted = corrupted + deviation * rng.standard_normal(x.shape, dtype=x.dtype)
    return corrupted


def zero_values(x: np.ndarray, p: float | np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """X_c: each value of x set to zero with probability p, independently; zero is the mean pose.

    Parameters
    ----------
    x : array of float, any shape
    p : float or array
        Between 0 and 1; an array must broadcast to x.
    rng : numpy.random.Generator

    Returns
    -------
    corrupted : array of the same shape

    Raises
    ------
    ValueError
        If p is not a probability.

    References
    ----------
    holden2015, section 6: the corruption of denoising autoencoding.

    Examples
    --------
    >>> x = np.ones((1, 1000, 5), np.float32)
    >>> corrupted = zero_values(x, 0.1, np.random.default_rng(0))
    >>> round(float(corrupted.mean()), 1)
    0.9
    """
    if not np.all((0 <= np.asarray(p)) & (np.asarray(p) <= 1)):
        raise ValueError(f"p is {p}, expected a probability between 0 and 1")
    return x * (rng.random(x.shape, dtype=np.float32) >= p)


def unpooling_mask(x: np.ndarray, filters: int, rng: np.random.Generator) -> np.ndarray:
    """The mask of `ops.unpool_random` for a layer whose input is x, (B, T, C): (B, T/2, D).

    True (with probability 1/2) puts the unpooled value on the first frame of its pair, False on
    the second.
    """
    batch, frames, _ = x.shape
    return rng.random((batch, frames // 2, filters), dtype=np.float32) < 0.5


def damage_stretches(
    x: np.ndarray, chains: Sequence[Sequence[int]], size: float, rng: np.random.Generator
) -> np.ndarray:
    """X_c of windows (B, T, C) with the damage of motion files: up to three stretches in a window.
    It is not in holden2015, which only sets single values to zero.

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
    at_base = x[:, base : base + 3]
    for number, point in enumerate(points, start=1):
        value = x[where, point : point + 3]
        first = x[before, point : point + 3]
        kinds = (
            np.zeros(3),
            first,
            at_base[where] + (first - at_base[before]),
            (1 - t) * first + t * x[after, point : point + 3],
            value + (shift * number / len(points)).astype(x.dtype),
        )
        value[...] = kinds[kind]
