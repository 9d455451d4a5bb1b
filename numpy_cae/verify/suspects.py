"""The mistakes that a wrong gradient is tried for, one function each, the most telling first.

Each takes the point and the gradient by differences, and returns a sentence or None.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.verify.point import Point, gradient_by_differences

GATES = ("reset", "update", "new")
GRU_WEIGHTS = ("w", "u", "b", "c")


def _close(a: np.ndarray, b: np.ndarray) -> bool:
    """Equal as far as differences can tell, and not merely because both are nothing."""
    if np.shape(a) != np.shape(b) or np.size(a) == 0:
        return False
    size = np.linalg.norm(b)
    return size > 0 and bool(np.linalg.norm(np.subtract(a, b)) <= 1e-5 * size)


def dropped(at: Point) -> str:
    """What to say of a gradient that is 0 everywhere."""
    if at.name.startswith("h"):
        return f"the gradient of the first state is dropped: {at.name} gets nothing"
    return f"the gradient for {at.name} is dropped: it is 0 everywhere"


def _factor(at: Point, numeric: np.ndarray) -> str | None:
    """One constant between both gradients."""
    square = np.sum(numeric * numeric)
    factor = np.sum(at.gradient * numeric) / square if square else 0.0
    if not factor or not _close(at.gradient, factor * numeric):
        return None
    if np.isclose(factor, -1):
        return "the sign"
    for size, excess in ((abs(factor), "too much"), (1 / abs(factor), "too little")):
        names = [name for name, number in _counts(at) if number > 1 and np.isclose(size, number)]
        if names:
            return f"a factor of {', or of '.join(names)} {excess}{_and_sign(factor)}"
    if at.dy.ndim == 0 and np.isclose(factor * at.dy, 1):
        return "the upstream number is not used: multiply by it"
    return f"a constant factor, {factor:.6g}, that should be 1"


def _and_sign(factor: float) -> str:
    return ", and the sign" if factor < 0 else ""


def _counts(at: Point) -> Iterator[tuple[str, int]]:
    """The numbers by which sums, means and squares go wrong, commonest first."""
    yield "2", 2
    if at.dy.ndim == 0:
        count = at.x.size
        yield f"N = {count}, the number of entries (a sum for a mean, or the reverse)", count
        yield f"2 N = {2 * count}, N being the number of entries", 2 * count
        yield f"{len(at.x)}, the length of the batch (a sum for a mean, or the reverse)", len(at.x)
    axes = ("the batch", "time")
    for axis, length in zip(axes, at.dy.shape, strict=False):
        yield f"{length}, the length of {axis} (a mean for a sum, or the reverse)", length
    if at.dy.ndim > 1:
        rows = int(np.prod(at.dy.shape[:-1]))
        yield f"{rows}, the windows times the frames (a mean for a sum, or the reverse)", rows


def _rearranged(at: Point, numeric: np.ndarray) -> str | None:
    """The right numbers in the wrong places."""
    gradient = at.gradient
    if gradient.ndim >= 2 and _close(np.swapaxes(gradient, -1, -2), numeric):
        return "a transpose of the last two axes"
    if gradient.ndim == 3 and _close(gradient[::-1], numeric):
        return "the taps are in reverse: the filters are flipped where they should not be, or not"
    if gradient.ndim == 3 and _close(gradient[:, ::-1], numeric):
        return "the frames are in reverse"
    if gradient.size > 1 and _close(np.sort(gradient, axis=None), np.sort(numeric, axis=None)):
        return "the right numbers in the wrong order: a permutation is not undone"
    return None


def _shifted(at: Point, numeric: np.ndarray) -> str | None:
    """Off by one along time, or along the taps."""
    if at.x.ndim != 3 or at.dy.ndim != 3:
        return None
    axis = 0 if at.name == "w" else 1
    here, there = at.gradient, numeric
    if axis == 1:  # what a single frame in the middle sends back, clear of both edges
        alone = _alone(at.dy, 1, at.dy.shape[1] // 2)
        here, there = at.pulled(alone), gradient_by_differences(at, alone)
    here, there = np.moveaxis(here, axis, 0), np.moveaxis(there, axis, 0)
    if _close(here[1:], there[:-1]) or _close(here[:-1], there[1:]):
        return "off by one in the padding: the gradient is shifted by one place"
    return None


def _insensitive(at: Point, numeric: np.ndarray) -> str | None:
    """A sum that has only one term: the pullback does not notice the others being zeroed."""
    for axis, what in ((0, "the batch"), (1, "time")):
        if at.dy.ndim <= axis + 1 or at.dy.shape[axis] < 2:
            continue
        for one in range(at.dy.shape[axis]):
            if np.array_equal(at.pulled(_alone(at.dy, axis, one)), at.gradient):
                return f"a missing sum over {what}: only index {one} of it counts"
    return None


def _filters(at: Point, numeric: np.ndarray) -> str | None:
    """Experiments with the filters: another argument with three axes, taps first."""
    for i, w in enumerate(at.inputs):
        if i == at.position or w.ndim != 3 or at.x.ndim != 3 or len(w) < 2:
            continue
        if _close(at.pulled(at.dy, _with(at.inputs, i, w[::-1])), numeric):
            return "the filters are not flipped in time"
        for tap in range(len(w)):
            alone = np.zeros_like(w)
            alone[tap] = w[tap]
            if np.array_equal(at.pulled(at.dy, _with(at.inputs, i, alone)), at.gradient):
                return f"a missing sum over taps: only tap {tap} counts"
    return None


def _passed_through(at: Point, numeric: np.ndarray) -> str | None:
    if at.gradient.shape == at.dy.shape and np.array_equal(at.gradient, at.dy):
        return "the upstream gradient is passed on as it is: the operation's own derivative lacks"
    return None


def _gates(at: Point, numeric: np.ndarray) -> str | None:
    """Which gate of a GRU is wrong, seen at the bias b, which nothing else disturbs."""
    if not set(GRU_WEIGHTS) <= set(at.names):
        return None
    # c shows what b does not: the factor r of the new gate's product with the state.
    for name in dict.fromkeys((at.name, "b", "c")):
        position = list(at.names).index(name)
        there = replace(at, position=position)
        if name not in GRU_WEIGHTS:
            continue
        there = replace(there, gradient=there.pulled(at.dy))
        sentence = _gate_by_gate(there, gradient_by_differences(there))
        if sentence:
            return sentence
    return None


def _gate_by_gate(at: Point, numeric: np.ndarray) -> str | None:
    ours, theirs = (np.split(g, 3, axis=-1) for g in (at.gradient, numeric))
    for one, other in ((0, 1), (1, 2), (0, 2)):
        if _close(ours[one], theirs[other]) and _close(ours[other], theirs[one]):
            return f"the gates {GATES[one]} and {GATES[other]} are exchanged"
    wrong = [gate for gate, a, n in zip(GATES, ours, theirs, strict=True) if not _close(a, n)]
    if len(wrong) != 1:
        return None
    if not np.any(ours[GATES.index(wrong[0])]):
        return f"the path through the {wrong[0]} gate is missing: nothing comes through it"
    return f"a gate's derivative is missing or wrong: only the {wrong[0]} gate's part differs"


def _left_out(at: Point, numeric: np.ndarray) -> str | None:
    """One frame that is wrong where all others are right."""
    if at.x.ndim != 3 or at.x.shape[1] < 2 or at.name == "w":
        return None
    wrong = np.abs(at.gradient - numeric) > 1e-5 * np.sqrt(np.mean(numeric * numeric))
    frames = np.flatnonzero(wrong.any(axis=(0, 2)))
    if len(frames) == 1:
        return f"only frame {frames[0]} of {at.x.shape[1]} is wrong: one time step is left out"
    if set(frames) <= {0, at.x.shape[1] - 1}:
        return "the padding: only the first and the last frame are wrong"
    return None


def _right_when_single(at: Point, numeric: np.ndarray) -> str | None:
    """Right for a single frame or window, wrong for several: a sum, or a path between them."""
    for axis, one, what in ((1, "frame", "time"), (0, "window", "the batch")):
        if at.dy.ndim <= axis + 1 or at.dy.shape[axis] < 2:
            continue
        cut = [_first_of(a, axis, at.dy.shape[axis]) for a in at.inputs]
        try:
            value, pullback = at.f(*(a.copy() for a in cut))
            there = replace(at, inputs=cut, value=np.asarray(value), dy=_first_of(at.dy, axis))
            pulled = pullback(there.dy)
        except Exception:  # the shapes were not what they seemed
            continue
        pulled = pulled[at.position] if isinstance(pulled, tuple | list) else pulled
        if _close(pulled, gradient_by_differences(there)):
            return (
                f"a missing sum over {what}, or what is carried along it: "
                f"the gradient is right for a single {one}"
            )
    return None


def _first_of(array: np.ndarray, axis: int, length: int | None = None) -> np.ndarray:
    """The first index along an axis, where the axis has this length at all."""
    has_axis = array.ndim >= 2 + axis and length in (None, array.shape[axis])
    return array[(slice(None),) * axis + (slice(0, 1),)] if has_axis else array


def _alone(array: np.ndarray, axis: int, index: int) -> np.ndarray:
    """The array with all but one index along an axis zeroed."""
    alone = np.zeros_like(array)
    chosen = (slice(None),) * axis + (index,)
    alone[chosen] = array[chosen]
    return alone


def _with(inputs: Sequence[np.ndarray], i: int, other: np.ndarray) -> list[np.ndarray]:
    return [other if j == i else array for j, array in enumerate(inputs)]


SUSPECTS = (
    _factor,
    _rearranged,
    _shifted,
    _insensitive,
    _filters,
    _passed_through,
    _gates,
    _left_out,
    _right_when_single,
)
