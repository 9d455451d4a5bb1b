"""Central differences against a pullback: the test that every derivative here has to pass."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.verify import differences
from numpy_cae.verify.differences import KINK, WRONG, Verdict

EVERY_ENTRY_UP_TO = 100
DIRECTIONS = 10
KINKS_EXCUSED = 0.05
COARSE = "\nthe value is computed in float32, too coarse for its slope to be measured"


@dataclass(frozen=True)
class Point:
    """Where the gradient for one argument is checked."""

    f: Callable
    inputs: Sequence[np.ndarray]
    position: int
    value: np.ndarray
    dy: np.ndarray
    gradient: np.ndarray

    @property
    def x(self) -> np.ndarray:
        return self.inputs[self.position]

    def value_at(self, x: np.ndarray) -> np.ndarray:
        """f with this argument at x; f gets copies, so that it cannot change the others."""
        arguments = [x if i == self.position else a.copy() for i, a in enumerate(self.inputs)]
        return np.asarray(self.f(*arguments)[0])

    def is_coarse(self) -> bool:
        """Whether the value has the precision of float32 only: its slope cannot be measured."""
        nearby = self.value_at(self.x * (1 + 1e-10) + 1e-10)
        rounded = nearby.astype(np.float32)
        return bool(np.any(nearby % 0.0625)) and np.array_equal(nearby, rounded)


def check_gradients(
    f: Callable,
    *inputs: np.ndarray,
    rng: np.random.Generator | None = None,
    tolerance: float = 1e-6,
    names: Sequence[str] | None = None,
    only: Sequence[str] | None = None,
) -> None:
    """Raise unless the pullback of f agrees with central differences in every argument.

    The upstream gradient is random, never all ones. Inputs of up to 100 entries are checked entry
    by entry, larger ones along 10 random directions; a failure there is traced to one entry by
    halving the direction. An entry at a kink (a tie of max, the 0 of |x|) cannot be judged and is
    excused, but at most one in twenty, or one where there are fewer.

    Parameters
    ----------
    f : (*inputs) -> (value, pullback)
        In the form of `numpy_cae.ops`; the value may be a scalar. Arguments without a gradient
        (masks, targets) are closed over: `lambda y: unpool_random(y, first)`. A whole model goes
        in wrapped, and its pullback takes the upstream number like any other:
        `lambda *w: (loss, lambda dloss: tuple(dloss * g for g in gradients))`.
    *inputs : arrays of float64
    rng : numpy.random.Generator, optional
        For the upstream gradient and the directions; the default has a fixed seed, so that a
        failure is repeatable.
    tolerance : float
        Relative to the larger of both numbers and the root mean square of the gradient.
    names : sequence of str, optional
        The names of the arguments in messages; by default their names in f's signature.
    only : sequence of str, optional
        The names of the arguments to check; by default all of them.

    Raises
    ------
    AssertionError
        With the argument, the index and both numbers.
    TypeError
        If an input is not an array of float64, or f does not return a value and a pullback.
    """
    rng = np.random.default_rng(0) if rng is None else rng
    names = tuple(names) if names is not None else _names(f, len(inputs))
    for name, x in zip(names, inputs, strict=True):
        if not isinstance(x, np.ndarray) or x.dtype != np.float64:
            raise TypeError(f"{name} must be an array of float64 for differences to mean much")

    copies = [x.copy() for x in inputs]
    value, pullback = value_and_pullback(f, inputs)
    dy = rng.standard_normal(np.shape(value))
    dy = dy if np.ndim(value) else dy[()]
    dy_copy = np.copy(dy)
    gradients = as_gradients(pullback(dy), len(inputs))
    _require_untouched((*names, "the upstream gradient"), (*inputs, dy), (*copies, dy_copy))

    for position, name in enumerate(names):
        if only is None or name in only:
            _check_argument(
                f, copies, position, names, value, dy, gradients[position], rng, tolerance
            )


def value_and_pullback(f: Callable, inputs: Sequence[np.ndarray]) -> tuple[np.ndarray, Callable]:
    """Call f; raise a TypeError unless it returns a value and a pullback."""
    returned = f(*inputs)
    if not (isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1])):
        raise TypeError(
            "expected a value and its pullback, a tuple of an array and a function, "
            f"got {_described(returned)}"
        )
    value, pullback = returned
    if not np.issubdtype(np.asarray(value).dtype, np.floating):
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


def _check_argument(f, inputs, position, names, value, dy, gradient, rng, tolerance) -> None:
    x, name = inputs[position], names[position]
    at = Point(f, inputs, position, value, dy, gradient)
    if np.shape(gradient) != x.shape or gradient is None:
        found = "None" if gradient is None else f"shape {np.shape(gradient)}"
        raise AssertionError(
            f"the gradient for {name} is {found}, expected shape {x.shape}, that of {name}"
        )
    if not isinstance(gradient, np.ndarray | np.generic):
        raise AssertionError(
            f"the gradient for {name} is a {type(gradient).__name__}, not an array"
        )
    if not np.all(np.isfinite(gradient)):
        index = _plain(np.argwhere(~np.isfinite(gradient))[0])
        raise AssertionError(f"the gradient for {name} is {gradient[index]} at index {index}")

    directions = list(_directions(x, rng))
    verdicts = [_compare(at, direction, tolerance) for direction in directions]
    wrong = [i for i, verdict in enumerate(verdicts) if verdict.kind == WRONG]
    kinks = [i for i, verdict in enumerate(verdicts) if verdict.kind == KINK]
    tried = "entries" if x.size <= EVERY_ENTRY_UP_TO else "random directions"
    if wrong:
        worst = max(wrong, key=lambda i: abs(verdicts[i].numeric - verdicts[i].analytic))
        index, verdict = _trace(at, directions[worst], verdicts[worst], tolerance)
        raise AssertionError(
            f"the gradient for {name}, shape {x.shape}, is wrong at index {index}\n"
            f"    by the pullback         {verdict.analytic:.10g}\n"
            f"    by central differences  {verdict.numeric:.10g}\n"
            f"    wrong in {len(wrong)} of {len(verdicts)} {tried}" + (COARSE * at.is_coarse())
        )
    if len(kinks) > max(1, int(KINKS_EXCUSED * len(verdicts))):
        raise AssertionError(
            f"the slope in {name}, shape {x.shape}, does not settle in {len(kinks)} of "
            f"{len(verdicts)} {tried}, more than may be excused as kinks"
            + (COARSE * at.is_coarse())
        )


def _compare(at: Point, direction: np.ndarray, tolerance: float) -> Verdict:
    """The pullback's derivative along `direction` against that of the differences."""
    size = np.sqrt(np.mean(at.gradient * at.gradient)) * np.linalg.norm(direction)
    return differences.judge(
        lambda step: differences.measure(at.value_at, at.x, direction, at.dy, at.value, step),
        float(np.sum(at.gradient * direction)),
        tolerance,
        float(size),
    )


def _directions(x: np.ndarray, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Every entry in turn, or random directions; as long as the entries are large."""
    scale = differences.step_scale(x)
    if x.size <= EVERY_ENTRY_UP_TO:
        for entry in range(x.size):
            yield _restricted(scale, [entry])
    else:
        for _ in range(DIRECTIONS):
            yield rng.standard_normal(x.shape) * scale


def _restricted(direction: np.ndarray, entries: Sequence[int]) -> np.ndarray:
    part = np.zeros(direction.size)
    part[entries] = direction.ravel()[entries]
    return part.reshape(direction.shape)


def _trace(at: Point, direction, verdict, tolerance) -> tuple[tuple[int, ...], Verdict]:
    """Halve a failing direction until one entry is left; return its index and both numbers."""
    entries = np.flatnonzero(direction)
    while len(entries) > 1:
        halves = np.array_split(entries, 2)
        judged = [_compare(at, _restricted(direction, half), tolerance) for half in halves]
        worse = max((0, 1), key=lambda i: abs(judged[i].numeric - judged[i].analytic))
        entries, verdict = halves[worse], judged[worse]
    index = _plain(np.unravel_index(entries[0], direction.shape))
    length = direction[index]
    return index, Verdict(verdict.kind, verdict.numeric / length, verdict.analytic / length)


def _require_untouched(names, arrays, copies) -> None:
    for name, array, copy in zip(names, arrays, copies, strict=True):
        if not np.array_equal(array, copy):
            raise AssertionError(f"{name} was altered: an operation never changes its arguments")


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
