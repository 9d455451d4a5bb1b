"""Values and rotations interpolated over the frames in which they are unknown.

A rotation is interpolated as rotation vectors relative to the last known frame before the hole:

    R_t = R_a exp(x(t)),    x(t_k) = log(R_a⁻¹ R_k)  at the known frames t_k

x is one of the curves of `motion.key_curves`, or a mean of them.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.motion.angles import unwrapped
from numpy_cae.motion.key_curves import Curve, eased
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.quaternions import IDENTITY, from_vector, inverse, product, to_vector

EVERY = slice(None)
"""EVERY: all frames."""
CurveAt = Callable[[int, int], Curve]
"""The curve over the hole of a column that begins in a frame: column and frame to curve."""


def eased_everywhere(column: int, first: int) -> Curve:
    """`eased` over every hole, a `CurveAt`."""
    return eased


def over_holes(
    values: np.ndarray,
    missing: np.ndarray,
    rate: float,
    curve_at: CurveAt = eased_everywhere,
    frames: np.ndarray | slice = EVERY,
) -> np.ndarray:
    """Values (F, N, C) interpolated over a mask (F, N); a column without known values is kept.

    With a mask `frames` (F,), only these frames are returned: all of an hour take 0.4 GB.
    """
    filled = np.array(values[frames], dtype=np.float64)
    for columns, first, end, keys in _holes(missing, rate):
        known = values[np.ix_(keys, columns)]
        times = np.arange(first, end) / rate
        inside = curve_at(columns[0], first)(keys / rate, known, times)
        _put(inside, filled, columns, first, frames)
    return filled


def rotations_over_holes(
    rotations: np.ndarray,
    missing: np.ndarray,
    rate: float,
    curve_at: CurveAt = eased_everywhere,
    frames: np.ndarray | slice = EVERY,
) -> np.ndarray:
    """The same for rotations as quaternions (F, N, 4); see the equation of the module."""
    filled = np.array(rotations[frames])
    filled[:, np.flatnonzero(missing.all(axis=0))] = IDENTITY
    for columns, first, end, keys in _holes(missing, rate):
        before = int(np.searchsorted(keys, first))  # keys before the hole
        start = rotations[keys[max(before - 1, 0)], columns]
        vectors = to_vector(product(inverse(start), rotations[np.ix_(keys, columns)]))
        for side in (vectors[:before][::-1], vectors[max(before - 1, 0) :]):
            if np.abs(side).max(initial=0.0) >= np.pi / 2:  # else none is half a turn away
                side[...] = unwrapped(side)
        times = np.arange(first, end) / rate
        turned = curve_at(columns[0], first)(keys / rate, vectors, times)
        _put(product(start, from_vector(turned)), filled, columns, first, frames)
    return filled


def _put(
    inside: np.ndarray,
    filled: np.ndarray,
    columns: np.ndarray,
    first: int,
    frames: np.ndarray | slice,
) -> None:
    """Put the values `inside` a hole, which begins in the frame `first`, into columns of `filled`,
    which has only the frames of the mask `frames`."""
    if not isinstance(frames, slice):
        inside = inside[frames[first : first + len(inside)]]
        first = int(np.count_nonzero(frames[:first]))
    filled[first : first + len(inside), columns] = inside


def _holes(missing: np.ndarray, rate: float) -> Iterator[tuple[np.ndarray, int, int, np.ndarray]]:
    """Each hole of a mask (F, N): its columns (those with the same holes together), its first frame
    and its end, and the known frames next to it, 2/30 s and a few frames more on both sides."""
    columns: dict[bytes, list[int]] = defaultdict(list)
    for column in np.flatnonzero(missing.any(axis=0) & ~missing.all(axis=0)):
        columns[missing[:, column].tobytes()].append(int(column))
    near = 2 * max(1, round(rate / RATE)) + 4
    for alike in columns.values():
        known = np.flatnonzero(~missing[:, alike[0]])
        for first, end in runs(missing[:, alike[0]]):
            after = int(np.searchsorted(known, first))
            yield np.array(alike), first, end, known[max(after - near, 0) : after + near]
