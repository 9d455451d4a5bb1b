"""Differences against a pullback: the test that every derivative here has to pass."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.verify import differences
from numpy_cae.verify.differences import KINK, WRONG, Line, Verdict

EVERY_ENTRY_UP_TO = 100
DIRECTIONS = 4
KINKS_EXCUSED = 0.05
SINGLE_TOLERANCE = 1e-4
"""The least tolerance where float32 is involved."""
SECOND_TOLERANCE = 1e-4
COARSE = "\nthe value is computed in float32, too coarse for its slope to be measured"


@dataclass(frozen=True)
class Point:
    """Where the gradient for one argument is checked."""

    f: Callable
    inputs: Sequence  # the differentiated ones in float64, which f keeps if it can
    position: int
    here: np.ndarray  # all outputs of floats, flat
    dy: np.ndarray
    gradient: np.ndarray
    epsilon: float

    @property
    def x(self) -> np.ndarray:
        return self.inputs[self.position]

    def outputs_at(self, x: np.ndarray) -> np.ndarray:
        """The outputs with this argument at x."""
        return _outputs(
            self.f, [*self.inputs[: self.position], x, *self.inputs[self.position + 1 :]]
        )

    def compare(self, direction: np.ndarray, tolerance: float) -> Verdict:
        """The pullback's derivative along a direction against that of the differences."""
        depend = np.zeros(self.here.shape, dtype=bool)
        line = Line(self.outputs_at, self.x, direction, self.dy, self.here, self.epsilon, depend)
        return differences.judge(line, float(np.sum(self.gradient * direction)), tolerance)

    def is_coarse(self) -> bool:
        """Whether the value has the precision of float32 only: its slope cannot be measured."""
        nearby = self.outputs_at(self.x * (1 + 1e-10) + 1e-10)
        return bool(np.any(nearby % 0.0625)) and np.array_equal(nearby, np.float32(nearby))


def check_gradients(
    f: Callable,
    *inputs: object,
    rng: np.random.Generator | None = None,
    tolerance: float = 1e-6,
    names: Sequence[str] | None = None,
    only: Sequence[str] | None = None,
    second: bool = False,
) -> None:
    """Raise unless the pullback of f agrees with differences in every argument.

    The upstream gradient is random, never all ones. Inputs of up to 100 entries are checked entry
    by entry, each with steps of its own; larger ones along random directions of entries that
    contribute alike, and a failure there is traced to one entry by halving the direction. The
    complex step decides where f is analytic and computes with complex numbers. An entry at a kink
    (a tie of max, the 0 of |x|) may have any slope between those to its left and right, but at
    most one entry in twenty, or one where there are fewer. f is called again, and must return the
    same.

    Parameters
    ----------
    f : (*inputs) -> (value, pullback)
        In the form of `numpy_cae.ops`. The value may be an array, a number, or a tuple of these;
        the pullback of a tuple takes a tuple, with None for what are no floats. A whole model
        goes in wrapped, and its pullback takes the upstream number like any other:
        `lambda *w: (loss, lambda dloss: tuple(dloss * g for g in gradients))`.
    *inputs : arrays of float64 or float32, and others
        Integers, bool arrays and whatever is no array of floats are not differentiated. The
        pullback returns a gradient for each of the others, or None for these. Where f computes in
        float64 if it is given that, gradients for float32 are compared with its differences.
    rng : numpy.random.Generator, optional
        For the upstream gradient and the directions; the default has a fixed seed, so that a
        failure is repeatable.
    tolerance : float
        Relative to the sizes of both numbers, and at least 1e-4 for float32.
    names : sequence of str, optional
        The names of the arguments in messages; by default their names in f's signature.
    only : sequence of str, optional
        The names of the arguments to check; by default all of them.
    second : bool
        Whether to check too that differences of the pullback's gradients are symmetric, and the
        second differences of the value: that it is right around the inputs, too.

    Raises
    ------
    AssertionError
        With the argument, the index and both numbers.
    TypeError
        If no input is an array of float64 or float32, or f does not return a value and a
        pullback.
    """
    rng = np.random.default_rng(0) if rng is None else rng
    names = tuple(names) if names is not None else _names(f, len(inputs))
    places = [i for i, x in enumerate(inputs) if _is_differentiated(names[i], x)]
    if not places:
        raise TypeError("no argument is an array of float64 or float32")

    before = _copies(inputs)
    value, pullback = _call(f, inputs)
    value = _copies(_parts(value)) if isinstance(value, tuple | list) else np.copy(value)
    dys = [_upstream(y, rng) for y in _parts(value)]
    given = _copies(dys)
    gradients = _gradients(pullback, value, given, inputs)
    _require_untouched(names, inputs, before)
    _require_untouched(["the upstream gradient"] * len(dys), given, dys)
    for i, gradient in zip(places, gradients, strict=True):
        _require_gradient(names[i], inputs[i].shape, gradient)
    again, pullback = _call(f, _copies(before))
    _require_same("value", _parts(value), _parts(again))
    _require_same("gradient", gradients, _gradients(pullback, value, _copies(dys), inputs))

    wide = [x.astype(np.float64) if i in places else x for i, x in enumerate(before)]
    at_wide = _parts(_call(f, _copies(wide))[0])
    is_single = any(inputs[i].dtype == np.float32 for i in places)
    is_coarse = any(np.asarray(y).dtype == np.float32 for y in at_wide)
    if is_coarse and not is_single:
        raise AssertionError("given float64, the value is float32" + COARSE)
    tolerance = max(tolerance, SINGLE_TOLERANCE) if is_single else tolerance
    epsilon = float(np.finfo(np.float32 if is_coarse else np.float64).eps)
    for i, gradient in zip(places, gradients, strict=True):
        if only is None or names[i] in only:
            at = Point(f, wide, i, _flat(at_wide), _flat(dys), np.asarray(gradient), epsilon)
            _check_argument(at, names[i], rng, tolerance)
    if second:
        _check_second(f, wide, dys, rng)


def value_and_pullback(f: Callable, inputs: Sequence[np.ndarray]) -> tuple[np.ndarray, Callable]:
    """Call f; raise a TypeError unless it returns an array or number of floats, and a pullback."""
    value, pullback = _call(f, inputs)
    if isinstance(value, tuple | list) or not _is_float(value):
        raise TypeError(f"expected a value of floats, got {_described(value)}")
    return np.asarray(value), pullback


def as_gradients(pulled, count: int) -> tuple:
    """What a pullback returned as a tuple; raise an AssertionError if it has another length."""
    gradients = pulled if isinstance(pulled, tuple | list) else (pulled,)
    if len(gradients) != count:
        raise AssertionError(
            f"the pullback returns {len(gradients)} gradient(s), expected {count}: one for each "
            "differentiated argument, in their order"
        )
    return tuple(gradients)


def _call(f: Callable, inputs: Sequence) -> tuple[object, Callable]:
    returned = f(*inputs)
    if not (isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1])):
        raise TypeError(
            "expected a value and its pullback, a tuple of an array and a function, "
            f"got {_described(returned)}"
        )
    if not any(map(_is_float, _parts(returned[0]))):
        raise TypeError(f"expected a value of floats, got {_described(returned[0])}")
    return returned


def _parts(value) -> Sequence:
    """The outputs of f: the entries of a tuple, or its one value."""
    return value if isinstance(value, tuple | list) else [value]


def _flat(parts: Sequence) -> np.ndarray:
    """All floats of some arrays, in one row."""
    return np.concatenate([np.ravel(part) for part in parts if _is_float(part)])


def _is_float(thing) -> bool:
    return thing is not None and np.issubdtype(np.asarray(thing).dtype, np.inexact)


def _outputs(f: Callable, inputs: Sequence) -> np.ndarray:
    """The outputs of f, flat; it gets copies, so that it cannot change its arguments."""
    with np.errstate(all="ignore"):
        return _flat(_parts(f(*_copies(inputs))[0]))


def _is_differentiated(name: str, x: object) -> bool:
    if not isinstance(x, np.ndarray) or not np.issubdtype(x.dtype, np.inexact):
        return False
    if x.dtype not in (np.float64, np.float32):
        raise TypeError(f"{name} must be an array of float64 or float32, not of {x.dtype}")
    return True


def _upstream(value, rng: np.random.Generator):
    """A random upstream gradient for one output; None for what is no float."""
    if not _is_float(value):
        return None
    dy = rng.standard_normal(np.shape(value)).astype(np.asarray(value).dtype)
    return dy if np.ndim(value) else dy[()]


def _gradients(pullback: Callable, value, dys: Sequence, inputs: Sequence) -> tuple:
    """The gradients of the differentiated arguments; a pullback may return None for the others."""
    pulled = pullback(tuple(dys) if isinstance(value, tuple | list) else dys[0])
    places = [i for i, x in enumerate(inputs) if _is_differentiated("an argument", x)]
    if isinstance(pulled, tuple | list) and len(pulled) == len(inputs):
        return tuple(pulled[i] for i in places)
    return as_gradients(pulled, len(places))


def _require_gradient(name: str, shape: tuple[int, ...], gradient) -> None:
    """Raise unless a gradient is an array of finite real numbers in the shape of its argument."""
    if np.shape(gradient) != shape or gradient is None:
        found = "None" if gradient is None else f"shape {np.shape(gradient)}"
        raise AssertionError(
            f"the gradient for {name} is {found}, expected shape {shape}, that of {name}"
        )
    if not isinstance(gradient, np.ndarray | np.generic) or np.iscomplexobj(gradient):
        found = type(gradient).__name__
        raise AssertionError(f"the gradient for {name} is a {found}, not an array of floats")
    if not np.all(np.isfinite(gradient)):
        index = _plain(np.argwhere(~np.isfinite(gradient))[0])
        raise AssertionError(f"the gradient for {name} is {gradient[index]} at index {index}")


def _check_argument(at: Point, name: str, rng: np.random.Generator, tolerance: float) -> None:
    """Compare one gradient with differences, and tell where they disagree most."""
    tried = "entries" if at.x.size <= EVERY_ENTRY_UP_TO else "random directions"
    directions = list(_directions(at.x, at.gradient, rng))
    verdicts = [at.compare(direction, tolerance) for direction in directions]
    if tried != "entries" and any(verdict.kind == KINK for verdict in verdicts):
        entries = rng.choice(at.x.size, EVERY_ENTRY_UP_TO, replace=False)
        kept = [d for d, verdict in zip(directions, verdicts, strict=True) if verdict.kind == WRONG]
        directions = [*kept, *_entries(at.x, entries)]
        verdicts = [at.compare(direction, tolerance) for direction in directions]
    of = {kind: [i for i, v in enumerate(verdicts) if v.kind == kind] for kind in (WRONG, KINK)}
    place = f"{name}, shape {at.x.shape},"
    if of[WRONG]:
        worst = max(of[WRONG], key=lambda i: abs(verdicts[i].numeric - verdicts[i].analytic))
        index, verdict = _trace(at, directions[worst], verdicts[worst], tolerance)
        raise AssertionError(
            f"the gradient for {place} is wrong at index {index}\n"
            f"    by the pullback         {verdict.analytic:.10g}\n"
            f"    by central differences  {verdict.numeric:.10g}\n"
            f"    wrong in {len(of[WRONG])} of {len(verdicts)} {tried}" + COARSE * at.is_coarse()
        )
    if len(of[KINK]) > max(1, int(KINKS_EXCUSED * len(verdicts))):
        index, verdict = _trace(at, directions[of[KINK][0]], verdicts[of[KINK][0]], tolerance)
        raise AssertionError(
            f"{place} has a kink in {len(of[KINK])} of {len(verdicts)} entries, such as {index}: "
            f"slope {verdict.left:.6g} to the left, {verdict.right:.6g} to the right\n"
            "    too many to be excused: choose inputs away from kinks" + COARSE * at.is_coarse()
        )


def _directions(
    x: np.ndarray, gradient: np.ndarray, rng: np.random.Generator
) -> Iterator[np.ndarray]:
    """Every entry in turn; of a large array, random directions of entries that contribute alike.

    What a small entry contributes would be lost beside that of a large one.
    """
    if x.size <= EVERY_ENTRY_UP_TO:
        yield from _entries(x, range(x.size))
        return
    scale = differences.step_scale(x)
    contribution = np.abs(gradient) * scale
    decades = np.round(np.log10(np.maximum(contribution, 1e-30)) / 3)
    for alike in np.unique(decades):
        for _ in range(DIRECTIONS):
            yield rng.standard_normal(x.shape) * scale * (decades == alike)


def _entries(x: np.ndarray, entries: Iterable[int]) -> Iterator[np.ndarray]:
    """Directions of single entries, each as long as its entry is large."""
    scale = differences.step_scale(x)
    return (_restricted(scale, [entry]) for entry in entries)


def _restricted(direction: np.ndarray, entries: Sequence[int]) -> np.ndarray:
    part = np.zeros(direction.size)
    part[entries] = direction.ravel()[entries]
    return part.reshape(direction.shape)


def _trace(at: Point, direction, verdict, tolerance) -> tuple[tuple[int, ...], Verdict]:
    """Halve a failing direction until one entry is left; return its index and both numbers."""
    entries = np.flatnonzero(direction)
    while len(entries) > 1:
        halves = np.array_split(entries, 2)
        judged = [at.compare(_restricted(direction, half), tolerance) for half in halves]
        worse = max((0, 1), key=lambda i: abs(judged[i].numeric - judged[i].analytic))
        entries, verdict = halves[worse], judged[worse]
    index = _plain(np.unravel_index(entries[0], direction.shape))
    numbers = (verdict.numeric, verdict.analytic, verdict.left, verdict.right)
    return index, Verdict(verdict.kind, *(number / direction[index] for number in numbers))


def _require_untouched(names, arrays, copies) -> None:
    for name, array, copy in zip(names, arrays, copies, strict=True):
        if isinstance(array, np.ndarray) and not np.array_equal(array, copy, equal_nan=True):
            raise AssertionError(f"{name} was altered: an operation never changes its arguments")


def _require_same(what: str, first: Sequence, second: Sequence) -> None:
    """Raise unless a second call of f returned what the first did."""
    one, other = _flat(first), _flat(second)
    allowed = 1000 * np.finfo(one.dtype).eps * np.max(np.abs(one), initial=0.0)
    if one.shape != other.shape or not np.allclose(one, other, 0, allowed, equal_nan=True):
        raise AssertionError(
            f"called again, f returns another {what}: randomness comes in as an argument"
        )


def _check_second(f: Callable, inputs: Sequence, dys: Sequence, rng: np.random.Generator) -> None:
    """Raise unless the gradients nearby are those of one function, which has this value."""
    places = [i for i, x in enumerate(inputs) if _is_differentiated("an argument", x)]
    scale = np.concatenate([differences.step_scale(inputs[i]).ravel() for i in places])
    ends = np.cumsum([inputs[i].size for i in places])[:-1]
    epsilon = np.finfo(np.float64).eps

    def moved(shift: np.ndarray) -> list:
        arguments = _copies(inputs)
        for i, part in zip(places, np.split(shift, ends), strict=True):
            arguments[i] += part.reshape(arguments[i].shape)
        return arguments

    def gradient(shift: np.ndarray) -> np.ndarray:
        value, pullback = _call(f, moved(shift))
        return _flat(_gradients(pullback, value, _copies(dys), inputs))

    def loss(shift: np.ndarray) -> float:
        return float(np.sum(_flat(dys) * _outputs(f, moved(shift))))

    def bend(along: np.ndarray, of: np.ndarray) -> tuple[float, float]:
        """of' H along, and what it may be off by."""
        step = np.cbrt(epsilon)
        ahead, behind = gradient(step * along), gradient(-step * along)
        size = np.abs(of) @ np.abs(ahead - behind) + 32 * epsilon * np.abs(of) @ np.abs(ahead)
        return of @ (ahead - behind) / (2 * step), SECOND_TOLERANCE * size / (2 * step)

    u, v = rng.standard_normal((2, scale.size)) * scale
    (one, allowed), (other, _), (straight, margin) = bend(v, u), bend(u, v), bend(v, v)
    if abs(one - other) > allowed + 1e-6 * abs(other):
        raise AssertionError(
            f"second derivatives: u' H v is {one:.8g}, v' H u is {other:.8g}: near the inputs the "
            "pullback does not return the gradient of one function"
        )
    step = epsilon**0.25
    second = (loss(step * v) - 2 * loss(0 * v) + loss(-step * v)) / step**2
    noise = 32 * epsilon * np.sum(np.abs(_flat(dys) * _outputs(f, inputs))) / step**2
    if abs(second - straight) > margin + 1e-3 * abs(second) + noise:
        raise AssertionError(
            f"second derivatives: v' H v is {straight:.8g} by the pullback, {second:.8g} by second "
            "differences of the value"
        )


def _names(f: Callable, count: int) -> tuple[str, ...]:
    """The names of f's arguments, or their positions where it has none to tell."""
    try:
        parameters = list(inspect.signature(f).parameters.values())
    except (TypeError, ValueError):
        parameters = []
    named = [p.name for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    return (
        tuple(named[:count])
        if len(named) >= count
        else tuple(f"argument {i}" for i in range(count))
    )


def _plain(index: Sequence[int]) -> tuple[int, ...]:
    return tuple(int(i) for i in index)


def _described(thing) -> str:
    if isinstance(thing, np.ndarray):
        return f"an array of {thing.dtype}, shape {thing.shape}"
    return f"a tuple of {len(thing)}" if isinstance(thing, tuple) else f"{type(thing).__name__}"


def _copies(things: Sequence) -> list:
    return [np.copy(x) if isinstance(x, np.ndarray) else x for x in things]
