"""What a wrong gradient looks like, and the mistake that usually looks that way.

Two kinds of evidence: the pattern in the numbers (the pullback's gradient against the one by
differences: turned around, transposed, shifted, a constant factor apart), and experiments on the
pullback itself (does it notice when all but one window of the upstream gradient is zeroed? does it
become right when the filters are flipped?).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.verify.differences import FIRST_STEP, step_scale

DIFFERENCES_UP_TO = 600
COARSE = "the value is computed in float32, too coarse for its slope to be measured"
GATES = ("reset", "update", "new")


@dataclass(frozen=True)
class Point:
    """Where a gradient was tried: the function, its arguments, and the argument in question."""

    f: Callable
    inputs: Sequence[np.ndarray]
    position: int
    names: Sequence[str]
    value: np.ndarray
    dy: np.ndarray
    gradient: np.ndarray

    @property
    def x(self) -> np.ndarray:
        return self.inputs[self.position]

    @property
    def name(self) -> str:
        return self.names[self.position]

    def moved_to(self, x: np.ndarray) -> np.ndarray:
        """f with this argument at x. Copies, lest f alter its arguments and so the point."""
        arguments = [x if i == self.position else a.copy() for i, a in enumerate(self.inputs)]
        return np.asarray(self.f(*arguments)[0])

    def pulled(self, dy: np.ndarray, inputs: Sequence[np.ndarray] | None = None) -> np.ndarray:
        """The pullback's gradient for this argument, with another dy or at other inputs."""
        arguments = [a.copy() for a in (self.inputs if inputs is None else inputs)]
        pulled = self.f(*arguments)[1](dy)
        return np.asarray(pulled[self.position] if isinstance(pulled, tuple | list) else pulled)


def likely_mistake(at: Point) -> str | None:
    """A sentence for the mistake that the wrong gradient at a point shows, or None."""
    if _is_coarse(at):
        return COARSE
    if at.x.size > DIFFERENCES_UP_TO:
        return None
    numeric = gradient_by_differences(at)
    if not np.any(at.gradient):
        return _dropped(at)
    for suspect in (_factor, _rearranged, _shifted, _insensitive, _filters, _passed_through, _part):
        sentence = suspect(at, numeric)
        if sentence:
            return sentence
    return None


def mistake_in_shape(at: Point) -> str | None:
    """A sentence for a gradient of the wrong shape, or None."""
    have, want = np.shape(at.gradient), at.x.shape
    if at.gradient is None:
        return "this argument's gradient was never computed"
    if have == want[::-1] or sorted(have) == sorted(want):
        return "a transpose: the axes are those of the argument in another order"
    if len(have) > len(want) and have[len(have) - len(want) :] == want:
        summed = have[: len(have) - len(want)]
        if at.dy.shape[: len(summed)] == summed:
            return "a missing sum over " + " and ".join(("the batch", "time")[: len(summed)])
        if len(summed) == 1 and at.dy.ndim > 1 and summed[0] == at.dy.shape[1]:
            return "a missing sum over time"
        return "a missing sum over the leading axes"
    return None


def mistake_in_error(error: Exception) -> str | None:
    """A sentence for an exception out of someone's implementation, or None."""
    text = str(error)
    if "mismatch in its core dimension" in text or "not aligned" in text:
        return "a transpose: the shapes of a matrix product do not fit"
    if "could not be broadcast" in text:
        return "the axes: an array has another shape than its destination"
    return None


def mistake_in_roughness(at: Point) -> str | None:
    """A sentence for a value whose slope settles nowhere, or None."""
    if _is_coarse(at):
        return COARSE
    return "the input sits on ties; or the value does not follow the input smoothly"


def _is_coarse(at: Point) -> bool:
    """Whether the value moves in float32's steps when the argument moves in smaller ones."""
    nearby = at.moved_to(at.x * (1 + 1e-10) + 1e-10)
    return bool(np.any(nearby % 0.0625)) and np.array_equal(nearby, nearby.astype(np.float32))


def gradient_by_differences(at: Point) -> np.ndarray:
    """The whole gradient, entry by entry."""
    numeric = np.empty(at.x.shape)
    steps = FIRST_STEP * step_scale(at.x)
    for index in np.ndindex(at.x.shape):
        plus, minus = at.x.copy(), at.x.copy()
        plus[index] += steps[index]
        minus[index] -= steps[index]
        rise = np.sum(at.dy * (at.moved_to(plus) - at.moved_to(minus)))
        numeric[index] = rise / (plus[index] - minus[index])
    return numeric


def _close(a: np.ndarray, b: np.ndarray) -> bool:
    """Equal as far as differences can tell, and not merely because both are nothing."""
    if np.shape(a) != np.shape(b) or np.size(a) == 0:
        return False
    size = np.linalg.norm(b)
    return size > 0 and bool(np.linalg.norm(np.subtract(a, b)) <= 1e-5 * size)


def _dropped(at: Point) -> str:
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
    for name, number in _counts(at):
        if np.isclose(abs(factor), number):
            return f"a factor of {name} too much{_and_sign(factor)}"
        if np.isclose(abs(factor), 1 / number):
            return f"a factor of {name} too little{_and_sign(factor)}"
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
        yield f"{len(at.x)}, the length of the batch", len(at.x)
    axes = ("the batch", "time", "the channels")
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
    for name, order in (("reset and update", (1, 0, 2)), ("update and new", (0, 2, 1))):
        if gradient.shape[-1] % 3 == 0:
            thirds = np.split(gradient, 3, axis=-1)
            if _close(np.concatenate([thirds[i] for i in order], axis=-1), numeric):
                return f"the gates {name} are exchanged"
    if gradient.size > 1 and _close(np.sort(gradient, axis=None), np.sort(numeric, axis=None)):
        return "the right numbers in the wrong order: a permutation is not undone"
    return None


def _shifted(at: Point, numeric: np.ndarray) -> str | None:
    """Off by one along time, or along the taps."""
    axis = 0 if at.name == "w" else 1
    if at.gradient.ndim != 3 or at.x.shape[axis] < 3:
        return None
    here, there = (np.moveaxis(array, axis, 0) for array in (at.gradient, numeric))
    if _close(here[1:], there[:-1]) or _close(here[:-1], there[1:]):
        return "off by one in the padding: the gradient is shifted by one place"
    middle = np.linalg.norm(here[1:-1] - there[1:-1]) <= 1e-5 * np.linalg.norm(there)
    if middle and axis == 1:
        return "the padding: only the first and the last frame are wrong"
    return None


def _insensitive(at: Point, numeric: np.ndarray) -> str | None:
    """A sum that has only one term: the pullback does not notice the others being zeroed."""
    for axis, what in ((0, "the batch"), (1, "time")):
        if at.dy.ndim <= axis + 1 or at.dy.shape[axis] < 2 or at.x.shape == at.dy.shape:
            continue
        for one in range(at.dy.shape[axis]):
            alone = np.zeros_like(at.dy)
            chosen = (slice(None),) * axis + (one,)
            alone[chosen] = at.dy[chosen]
            if np.array_equal(at.pulled(alone), at.gradient):
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


def _part(at: Point, numeric: np.ndarray) -> str | None:
    """Which part of the argument is wrong, where it is only a part."""
    wrong = np.abs(at.gradient - numeric) > 1e-5 * np.sqrt(np.mean(numeric * numeric))
    if at.x.shape[-1:] and at.x.shape[-1] % 3 == 0 and at.name in ("w", "u", "b", "c"):
        thirds = [bool(part.any()) for part in np.split(wrong, 3, axis=-1)]
        if sum(thirds) == 1:
            gate = GATES[thirds.index(True)]
            return f"a gate's derivative is missing or wrong: only the {gate} gate's part differs"
    if at.x.ndim == 3 and at.x.shape[1] > 1:
        frames = np.flatnonzero(wrong.any(axis=(0, 2)))
        if len(frames) == 1:
            return f"only frame {frames[0]} of {at.x.shape[1]} is wrong: one time step is left out"
    return None


def _with(inputs: Sequence[np.ndarray], i: int, other: np.ndarray) -> list[np.ndarray]:
    return [other if j == i else array for j, array in enumerate(inputs)]
