"""Interpolate values and rotations over holes: the frames in which they are unknown.

A `Hole` is a stretch of such frames, its keys are the known frames next to it, and a `Curve` goes
through the keys over the hole. A rotation is interpolated as rotation vectors relative to the last
known frame before the hole:

    R_t = R_a exp(x(t)),    x(t_k) = log(R_a⁻¹ R_k)  at the known frames t_k

x is one of the curves below, or a mean of them.

`pchip`, `cubic` and `slerp` are those of animation programs (`ROTATION_CURVES`). The speed of pchip
and slerp at the ends of a hole differs from that of the motion. `join_speeds` adds to PCHIP's curve
c the difference between the speed v of the motion at an end of the hole and the slope of c. With t
the time from that end and T at most the duration of the hole:

    x(t) = c(t) + (v - c'(0)) t (1 - |t| / T)²,  |t| < T

So value and speed are continuous at both ends. With T the duration of the hole this is the cubic
through values and speeds at both ends.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from numpy_cae.motion import quaternions
from numpy_cae.motion.angles import unwrap
from numpy_cae.motion.cubic_pieces import hermite, pchip_slopes, spline
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.quaternions import IDENTITY, from_vector, inverse, product, to_vector

EASE_SECONDS = 2 / 3
"""T of the module's equation (s) for the curve "eased", chosen among 0.13 to 0.8 s
(docs/lab_book/filling.md)."""
BRIEF_SECONDS = 0.1
"""T (s) for other curves: their speed does not jump, and little else changes."""
Curve = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""A curve through keys: their times (K,) in seconds, ascending, their values (K, N, C), and the
times (n,) of a hole between them, to values (n, N, C). Outside the keys the curve is constant."""


def pchip(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The monotone cubic of Fritsch and Butland (1984): no overshoot."""
    if len(keys) == 1:
        return np.repeat(values, len(times), axis=0)
    inside = np.clip(times, keys[0], keys[-1])
    return hermite(keys, values, pchip_slopes(keys, values), inside)


def cubic(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The cubic spline, with continuous acceleration."""
    if len(keys) == 1:
        return np.repeat(values, len(times), axis=0)
    return spline(keys, values, np.clip(times, keys[0], keys[-1]))


def slerp(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Linear between the two keys next to the hole, as PCHIP is through two keys: for rotation
    vectors relative to the first of the two this is spherical interpolation."""
    after = int(np.clip(np.searchsorted(keys, times[0], "right"), 1, max(len(keys) - 1, 1)))
    near = slice(after - 1, after + 1)
    return pchip(keys[near], values[near], times)


def join_speeds(longest: float) -> Curve:
    """PCHIP with the speeds at both ends of the hole, by the module's equation, T <= longest.

    Where the frames around the hole do not give its speed (`speed_at`), the curve is PCHIP's.
    """

    def joined(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
        result = pchip(keys, values, times)
        after = int(np.searchsorted(keys, times[0]))
        duration = longest
        slopes = np.zeros((2, *values.shape[1:]))  # of the constant outside of the keys
        if 0 < after < len(keys):
            ends = keys[after - 1 : after + 1]
            duration = min(longest, ends[1] - ends[0])
            slopes = pchip_slopes(keys, values)[after - 1 : after + 1]
        # From the hole outwards: the keys before it, the nearest first, and those after it.
        sides = ((keys[:after][::-1], values[:after][::-1]), (keys[after:], values[after:]))
        for (side_keys, side_values), slope in zip(sides, slopes, strict=True):
            speed = speed_at(side_keys, side_values)
            if speed is not None:
                t = (times - side_keys[0])[:, None, None]
                ramp = np.clip(1 - np.abs(t) / duration, 0.0, None) ** 2
                result += (speed - slope) * t * ramp
        return result

    return joined


def speed_at(times: np.ndarray, values: np.ndarray) -> np.ndarray | None:
    """The speed (N, C) at the first of some keys: the derivative of the parabola through it and
    the keys 1/30 s and 2/30 s away. None where these are not successive frames: speeds between
    sparse keyframes are PCHIP's."""
    if len(times) < 3:
        return None
    step = max(1, round(1 / (RATE * abs(times[1] - times[0]))))
    if len(times) <= 2 * step or abs(times[2 * step] - times[0]) > 2.5 / RATE:
        return None
    x0, x1, x2 = values[[0, step, 2 * step]]
    return (3 * x0 - 4 * x1 + x2) / (times[0] - times[2 * step])


ROTATION_CURVES: dict[str, Curve] = {"pchip": pchip, "cubic": cubic, "slerp": slerp}
eased = join_speeds(EASE_SECONDS)
CURVES: dict[str, Curve] = {
    "eased": eased,
    "pchip": join_speeds(BRIEF_SECONDS),
    "cubic": cubic,
}
"""The curves of `fill` and `repair` by name; the speed jumps in none of them."""


def mean_curve(weights: np.ndarray) -> Curve:
    """The mean of `CURVES` with these weights, (3,), whose sum is 1."""

    def mean(keys: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
        parts = [curve(keys, values, times) for curve in CURVES.values()]
        return np.tensordot(weights, parts, axes=1)

    return mean


ALL_FRAMES = slice(None)
CurveAt = Callable[[int, int], Curve]
"""From a column and the first frame of a hole in it to the curve over this hole."""


def eased_everywhere(column: int, first: int) -> Curve:
    """`eased` over every hole, a `CurveAt`."""
    return eased


class Hole(NamedTuple):
    """Frames from `first` to before `end` that are unknown in some columns, and its keys: the
    known frames next to it, 2/30 s and a few frames more on both sides."""

    columns: np.ndarray
    first: int
    end: int
    keys: np.ndarray


def find_holes(missing: np.ndarray, rate: float) -> Iterator[Hole]:
    """Each hole of a mask (F, N); columns with the same holes are taken together, and columns
    without known values are left out."""
    columns = np.flatnonzero(missing.any(axis=0) & ~missing.all(axis=0))
    if not len(columns):
        return
    patterns, numbers = np.unique(missing[:, columns], axis=1, return_inverse=True)
    near = 2 * max(1, round(rate / RATE)) + 4
    for number, pattern in enumerate(patterns.T):
        known_frames = np.flatnonzero(~pattern)
        for first, end in runs(pattern).tolist():
            after = int(np.searchsorted(known_frames, first))
            keys = known_frames[max(after - near, 0) : after + near]
            yield Hole(columns[numbers.ravel() == number], first, end, keys)


def interpolate_values(
    values: np.ndarray,
    missing: np.ndarray,
    rate: float,
    curve_at: CurveAt = eased_everywhere,
    frames: np.ndarray | slice = ALL_FRAMES,
) -> np.ndarray:
    """Values (F, N, C) interpolated over a mask (F, N); a column without known values stays.

    With a mask `frames` (F,), only these frames are returned: all of an hour take 0.4 GB.
    """
    filled = np.array(values[frames], dtype=np.float64)
    is_returned = _as_mask(frames, len(values))
    for hole in find_holes(missing, rate):
        keys = values[np.ix_(hole.keys, hole.columns)]
        _put(filled, is_returned, hole, _over_hole(hole, keys, rate, curve_at))
    return filled


def interpolate_rotations(
    rotations: np.ndarray,
    missing: np.ndarray,
    rate: float,
    curve_at: CurveAt = eased_everywhere,
    frames: np.ndarray | slice = ALL_FRAMES,
) -> np.ndarray:
    """The same for rotations as quaternions (F, N, 4), by the module's equation. A rotation that is
    never known is that of the rest pose."""
    filled = np.array(rotations[frames], dtype=np.float64)
    is_returned = _as_mask(frames, len(rotations))
    for hole in find_holes(missing, rate):
        start, vectors = _rotation_vectors(rotations[np.ix_(hole.keys, hole.columns)], hole)
        inside = product(start, from_vector(_over_hole(hole, vectors, rate, curve_at)))
        _put(filled, is_returned, hole, inside)
    filled[:, missing.all(axis=0)] = IDENTITY
    return filled


def _as_mask(frames: np.ndarray | slice, count: int) -> np.ndarray:
    mask = np.zeros(count, bool)
    mask[frames] = True
    return mask


def _rotation_vectors(rotations: np.ndarray, hole: Hole) -> tuple[np.ndarray, np.ndarray]:
    """R_a (N, 4) and the rotation vectors x(t_k) (K, N, 3) of the keys' rotations (K, N, 4).

    R_a is the last known rotation before the hole, or the first after it where none is before.
    """
    before = int(np.searchsorted(hole.keys, hole.first))
    last = max(before - 1, 0)
    start = rotations[last]
    vectors = to_vector(product(inverse(start), rotations))
    for side in (vectors[:before][::-1], vectors[last:]):
        if np.abs(side).max(initial=0.0) >= np.pi / 2:  # else none is half a turn away
            side[...] = unwrap(side)
    return start, vectors


def _over_hole(hole: Hole, keys: np.ndarray, rate: float, curve_at: CurveAt) -> np.ndarray:
    """The values (n, N, C) in a hole, by its curve through values (K, N, C) at its keys."""
    curve = curve_at(hole.columns[0], hole.first)
    times = np.arange(hole.first, hole.end) / rate
    return curve(hole.keys / rate, keys, times)


def _put(filled: np.ndarray, is_returned: np.ndarray, hole: Hole, inside: np.ndarray) -> None:
    """Put the values in a hole into the frames that are returned."""
    inside = inside[is_returned[hole.first : hole.end]]
    first = np.count_nonzero(is_returned[: hole.first])
    filled[first : first + len(inside), hole.columns] = inside


SHORT_SECONDS = 0.25
"""A damaged stretch of at most this duration (s) is interpolated with its spikes."""


def remove_seams(rotations: np.ndarray, damaged: np.ndarray, rate: float) -> np.ndarray:
    """The rotations (F, 4) of one joint, changed where `damaged` (F) to continue those around.

    Positions do not determine the rotation of a bone about its own axis, so retargeting takes it
    over from the original motion, where it would jump at both ends of a damaged stretch. A short
    stretch is therefore interpolated by slerp first. In a longer one, D_first and D_last are the
    corrections that would join its first and its last frame to the frames outside, and s runs from
    0 to 1 over the stretch:

        R'_t = R_t · quaternions.slerp(D_first, D_last; s),   D = R⁻¹ · (R continued from outside)

    This keeps the details in between, and it restores a joint that is frozen or off by a constant
    rotation.
    """
    changed = rotations.copy()
    for first, end in runs(damaged).tolist():
        is_short = end - first <= SHORT_SECONDS * rate
        if is_short and first > 0 and end < len(rotations):
            share = np.arange(1, end - first + 1) / (end - first + 1)
            changed[first:end] = quaternions.slerp(rotations[first - 1], rotations[end], share)
        else:
            changed[first:end] = join_rotations(rotations, first, end)
    return changed


def join_rotations(rotations: np.ndarray, first: int, end: int) -> np.ndarray:
    """The rotations (F, 4) of the frames from `first` to before `end`, turned to continue those
    outside: R'_t of `remove_seams`.

    Where the motion has no frame before or after them, the correction of the other end is for all;
    where it has neither, nothing changes.
    """
    inside = rotations[first:end]
    corrections = []
    if first > 0:
        before = rotations[max(first - 2, 0) : first]
        corrections.append(product(inverse(inside[0]), _continue(before)))
    if end < len(rotations):
        after = rotations[end : end + 2][::-1]  # backwards in time
        corrections.append(product(inverse(inside[-1]), _continue(after)))
    if not corrections:
        return inside
    share = np.linspace(0, 1, end - first)
    return product(inside, quaternions.slerp(corrections[0], corrections[-1], share))


def _continue(last: np.ndarray) -> np.ndarray:
    """The rotation (4,) that continues the last one or two, (1 or 2, 4)."""
    return product(product(last[-1], inverse(last[0])), last[-1])
