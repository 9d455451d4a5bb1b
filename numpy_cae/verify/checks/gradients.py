"""The gradient check: differences of the value are compared with what the pullback returns.

The slope of Σ dy ∘ f along an entry of an argument must equal the entry of the gradient that the
pullback returns for dy. This module handles arrays with too many entries to try each, float32 and
tuples; `differences` judges one direction.
"""

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.verify.checks import call as calling
from numpy_cae.verify.checks import differences
from numpy_cae.verify.checks.call import Mismatch, all_leaves, copies, flat, is_array, is_float
from numpy_cae.verify.checks.differences import AGREES, SINGLE, WRONG, Argument, Verdict

EVERY_ENTRY_UP_TO = 100
"""EVERY_ENTRY_UP_TO: arrays of at most so many entries are checked entry by entry."""
DIRECTIONS = 4
"""DIRECTIONS: a larger array is checked along so many random directions for each size of entry."""
ROUNDED = 2
"""ROUNDED: arrays of float32 are rounded so often to see what that changes of the gradients."""
EQUAL_ENTRIES = (1.7, 2.9)
"""EQUAL_ENTRIES: frequencies by which the step of an entry depends on its size."""
KINKS_EXCUSED = 0.05
"""KINKS_EXCUSED: kinks are excused in at most this share of the entries."""
TOGETHER = "all arguments together"
"""TOGETHER: the name in `only` for the check that moves equal entries by equal amounts."""
AGAIN = (
    "called again with -4 times the upstream gradient, the pullback does not return -4 times the "
    "gradients: it is not linear, or keeps something between calls"
)
OTHERWISE = "called again, f returns another {}: randomness comes in as an argument"
OVERWRITTEN = "the gradient that was returned first is overwritten by the second"


def check_gradients(
    f: Callable,
    *inputs: object,
    rng: np.random.Generator | None = None,
    tolerance: float = 1e-6,
    names: Sequence[str] | None = None,
    only: Sequence[str] | None = None,
) -> None:
    """Raise unless the pullback of f agrees with differences of the value, for every argument.

    docs/verify.md explains how steps are chosen, and how kinks and float32 are handled.

    Parameters
    ----------
    f : (*inputs) -> (value, pullback)
        In the form of `numpy_cae.ops`. The value may be an array, a number, or a tuple of these;
        the pullback of a tuple takes a tuple, with None in the place of an output without floats.
    *inputs : arrays of float64 or float32, and others
        Other arguments are not differentiated: the pullback returns no gradient for them, or None.
    rng : numpy.random.Generator, optional
        For the upstream gradient and the directions; the default has a fixed seed.
    tolerance : float
        Relative to the sizes of both numbers, and at least 1e-4 for float32.
    names : sequence of str, optional
        The names of the arguments in messages; by default the names in the signature of f.
    only : sequence of str, optional
        The names of the arguments to check, by default all.

    Raises
    ------
    AssertionError
        With the argument, the index and both numbers where they disagree.
    TypeError
        If no input is an array of floats, or f does not return a value and its pullback.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae.verify import check_gradients
    >>> x = np.array([0.5, 2.0])
    >>> check_gradients(lambda x: (x**3, lambda dy: 3 * x**2 * dy), x)
    >>> check_gradients(lambda x: (x**3, lambda dy: 3 * x * dy), x)
    Traceback (most recent call last):
    AssertionError: the gradient for x, shape (2,), is wrong at index (1,)
        ...
    """
    rng = np.random.default_rng(0) if rng is None else rng
    names = tuple(names) if names is not None else _names(f, len(inputs))
    problems = wrong_gradients(f, inputs, names, rng, tolerance, only)
    others = ("also: " + " ".join(str(problem).split()[:60]) for problem in problems[1:])
    if problems:
        raise AssertionError("\n".join([str(problems[0]), *others]))


def check_adjoint(f: Callable, x: np.ndarray, y: np.ndarray, tolerance: float = 1e-12) -> None:
    """Raise unless <f(x), y> = <x, pullback(y)>: no differences, no step, no truncation.

    A linear map A and its adjoint A' satisfy <A x, y> = <x, A' y> for every x and y, and the
    pullback of a linear operation is its adjoint.

    Parameters
    ----------
    f : x -> (value, pullback)
        Linear in x, with a gradient for x alone.
    x, y : arrays of float64
        An argument, and an array in the shape of f(x).
    tolerance : float
        Relative to |f(x)| |y| + |x| |pullback(y)|, which rounding is proportional to.

    Raises
    ------
    AssertionError
        With both inner products, or the shapes where they do not fit.

    Examples
    --------
    The adjoint of repeating each frame adds up the two frames of each pair.

    >>> import numpy as np
    >>> from numpy_cae.verify import check_adjoint
    >>> x, y = np.array([1.0, 2.0]), np.array([1.0, 2.0, 3.0, 5.0])
    >>> check_adjoint(lambda x: (np.repeat(x, 2), lambda dy: dy[::2] + dy[1::2]), x, y)
    >>> check_adjoint(lambda x: (np.repeat(x, 2), lambda dy: dy[::2]), x, y)
    Traceback (most recent call last):
    AssertionError: the pullback is not the adjoint: <A x, y> = 19, but <x, A' y> = 7
    """
    value, pullback = f(x)
    calling.require_shape("the value", value, np.shape(y))
    (pulled,) = calling.gradients_of(pullback(y), 1)
    calling.require_shape("what the pullback returns", pulled, np.shape(x))
    forward = float(np.sum(value * y))
    backward = float(np.sum(x * pulled))
    scale = np.linalg.norm(value) * np.linalg.norm(y) + np.linalg.norm(x) * np.linalg.norm(pulled)
    if not abs(forward - backward) <= tolerance * scale:
        products = f"<A x, y> = {forward:.12g}, but <x, A' y> = {backward:.12g}"
        raise AssertionError(f"the pullback is not the adjoint: {products}")


def wrong_gradients(
    f: Callable,
    inputs: Sequence,
    names: Sequence[str],
    rng: np.random.Generator,
    tolerance: float = 1e-6,
    only: Sequence[str] | None = None,
    upstream: Callable | None = None,
    kinks_excused: float = KINKS_EXCUSED,
) -> list[Mismatch]:
    """What is wrong with each gradient.

    `upstream` makes the upstream gradient of an output, by default random numbers. Kinks are
    excused in so large a share of the entries.
    """
    if not any(is_array(*leaf) for leaf in all_leaves(inputs, names)):
        raise TypeError("no argument is an array of float64 or float32")
    upstream = upstream or (lambda output: rng.standard_normal(np.shape(output)))
    problems: list[Mismatch] = []
    for argument in _arguments(_Called(f, inputs, names, only), upstream, tolerance):
        if argument.name.startswith(TOGETHER):
            problems += [] if problems else _judge_together(argument)
        else:
            problems += _judge(argument, rng, kinks_excused)
    return problems


@dataclass(frozen=True, eq=False)
class _Called:
    """A function, and the arguments that it is called with."""

    f: Callable
    inputs: Sequence
    names: Sequence[str]
    only: Sequence[str] | None

    @property
    def named(self) -> list[tuple[str, object]]:
        """The parts of the arguments by name."""
        return all_leaves(self.inputs, self.names)

    def chooses(self, name: str) -> bool:
        """Whether this argument, or the argument that it is a part of, is to be checked."""
        return self.only is None or bool({name, name.partition("[")[0]} & set(self.only))

    def outputs(self, leaves: Sequence) -> tuple[Sequence, Callable]:
        """The outputs for some arrays in place of those of the arguments, and the pullback."""
        value, pullback = calling.call(self.f, calling.rebuilt(self.inputs, iter(leaves)))
        if isinstance(value, tuple | list):
            return value, lambda dys: pullback(tuple(dys))
        return [value], lambda dys: pullback(dys[0])

    def output_at(self, leaves: list, places: Sequence[int], output: int) -> Callable:
        """One output, flat, as a function of the arrays at some places, given in one row."""
        ends = np.cumsum([leaves[place].size for place in places])[:-1]

        def at(row: np.ndarray) -> np.ndarray:
            given = copies(leaves)
            for place, part in zip(places, np.split(np.ravel(row), ends), strict=True):
                given[place] = part.reshape(leaves[place].shape)
            with np.errstate(all="ignore"):
                value = self.f(*calling.rebuilt(self.inputs, iter(given)))[0]
            return np.ravel(calling.parts(value)[output])

        return at

    def pulled(self, pullback: Callable, dys: Sequence) -> list:
        """The gradient for each array; raise a Mismatch if the upstream gradient is altered."""
        given = copies(dys)
        gradients = calling.gradients_of_leaves(self.inputs, self.names, pullback(given))
        for now, was in zip(given, dys, strict=True):
            _require_untouched("the upstream gradient", now, was)
        for (name, _), gradient in zip(self.named, gradients, strict=True):
            if self.chooses(name) or self.chooses(TOGETHER):
                calling.require_finite(f"the gradient for {name}", gradient)
        return gradients

    def pulled_twice(self, upstream: Callable) -> Iterator[tuple[int, object, list, list]]:
        """For each output its upstream gradient, the gradients where all others' are 0, and their
        rounding.

        Raise unless no argument is altered, a second call returns the same, and the pullback is
        proportional to the upstream gradient, one result independent of the next.
        """
        before = copies([leaf for _, leaf in self.named])
        value, pullback = self.outputs([leaf for _, leaf in self.named])
        outputs = copies(value)
        for output in outputs:
            calling.require_finite("the value", output)
        dys = [_upstream_of(output, upstream) for output in outputs]
        gradients = self.pulled(pullback, dys)
        kept = copies(gradients)
        for (name, leaf), was in zip(self.named, before, strict=True):
            _require_untouched(name, leaf, was)
        again = self.pulled(pullback, _times([-4.0] * len(dys), dys))
        size = max(float(np.max(np.abs(x), initial=0.0)) for x in before if is_float(x))
        _require_same(AGAIN, [-4.0 * g for g in kept if g is not None], again, size)
        _require_same(OVERWRITTEN, kept, gradients)
        repeated, pullback_again = self.outputs(copies(before))
        _require_same(OTHERWISE.format("value"), outputs, repeated)
        _require_same(OTHERWISE.format("gradient"), kept, self.pulled(pullback_again, dys))
        for number, dy in enumerate(dys):
            alone = _times(np.eye(len(dys))[number], dys)
            if dy is not None:
                of_one = copies(self.pulled(pullback, alone)) if len(dys) > 1 else kept
                yield number, dy, of_one, self.rounding(alone, of_one)

    def rounding(self, dys: Sequence, gradients: Sequence) -> list:
        """What rounding the arrays of float32 once more changes of each gradient, at most."""
        rng = np.random.default_rng(0)
        leaves = [leaf for _, leaf in self.named]
        narrow = [i for i, x in enumerate(leaves) if getattr(x, "dtype", None) == np.float32]
        changes = [None if gradient is None else 0 * gradient for gradient in gradients]
        for _ in range(ROUNDED if narrow else 0):
            rounded = copies(leaves)
            for i in narrow:
                rounded[i] *= 1 + rng.choice(np.float32([-SINGLE, SINGLE]), leaves[i].shape)
            both = zip(changes, self.pulled(self.outputs(rounded)[1], dys), gradients, strict=True)
            changes = [c if c is None else np.maximum(c, np.abs(p - g)) for c, p, g in both]
        return changes


def _upstream_of(output: object, upstream: Callable) -> object:
    """An upstream gradient in the dtype of the output; None for an output without floats."""
    dtype = np.asarray(output).dtype
    return np.array(upstream(output), dtype)[()] if is_float(output) else None


def _times(factors: Sequence[float], dys: Sequence) -> list:
    return [None if dy is None else a * dy for a, dy in zip(factors, dys, strict=True)]


def _arguments(called: _Called, upstream: Callable, tolerance: float) -> Iterator[Argument]:
    """Each array, with its gradient from each output and f as a function of it, in float64."""
    of_outputs = list(called.pulled_twice(upstream))
    for number, dy, *pulled in of_outputs:
        suffix = f" from output {number}" if len(of_outputs) > 1 else ""
        for argument in _arguments_of(called, number, dy, pulled, tolerance):
            yield replace(argument, name=argument.name + suffix)


def _arguments_of(
    called: _Called, number: int, dy: object, pulled: list[list], tolerance: float
) -> Iterator[Argument]:
    """The arguments for one output; the last one, TOGETHER, holds all arrays in one row.

    `pulled` are the gradients and what rounding may change of them.
    """
    leaves = [leaf for _, leaf in called.named]
    places = [i for i, gradient in enumerate(pulled[0]) if gradient is not None]
    wide = [np.array(x, np.float64) if i in places else x for i, x in enumerate(leaves)]
    y = np.asarray(called.outputs(copies(wide))[0][number])
    if any(getattr(array, "dtype", None) == np.float32 for array in (*leaves, y)):
        tolerance = max(tolerance, differences.SINGLE_TOLERANCE)
    options = {"dy": np.ravel(dy), "here": np.ravel(y), "tolerance": tolerance}
    options["epsilon"] = float(np.finfo(y.dtype).eps)
    in_single = False
    arrays = [(called.named[i][0], [i], wide[i].shape) for i in places]
    for name, where, shape in [*arrays, (TOGETHER, places, -1)]:
        if in_single and name == TOGETHER:
            options |= {"epsilon": SINGLE, "tolerance": differences.SINGLE_TOLERANCE}
        rows = (np.concatenate([np.ravel(each[i]) for i in where]) for each in (wide, *pulled))
        x, *changes = (row.reshape(shape) for row in rows)
        options |= dict(zip(("gradient", "rounding"), changes, strict=True))
        argument = Argument(name, called.output_at(wide, where, number), x, **options)
        if called.chooses(name):
            yield argument
        in_single = in_single or argument.is_computed_in_float32()


def _judge_together(at: Argument) -> Iterator[Mismatch]:
    """Move each entry in proportion to itself and to a number that depends on its size alone.

    Along such a direction equal entries stay equal, so that a maximum of them has no kink.
    """
    for frequency in EQUAL_ENTRIES if np.any(at.x) else ():
        verdict = at.judge(at.x * (2 + np.sin(frequency * np.abs(at.x))) / 8)
        if verdict.kind == WRONG:
            first = "where equal entries move by equal amounts, the gradients do not give the slope"
            last = "is a gradient given to each of several equal entries?"
            text = _both_numbers(first, verdict, last)
            yield Mismatch(calling.SLOPE, "the gradients together", text)
            return


def _both_numbers(first: str, verdict: Verdict, *others: str) -> str:
    """What is wrong, the pullback's number and that of differences."""
    numbers = calling.written_apart(verdict.analytic + 0, verdict.numeric + 0, 10)
    by_pullback = f"by the pullback                      {numbers[0]}"
    by_differences = f"by central differences of the value  {numbers[1]}"
    return "\n    ".join([first, by_pullback, by_differences, *others])


def _require_untouched(name: str, array: object, before: object) -> None:
    if isinstance(array, np.ndarray) and not np.array_equal(array, before, equal_nan=True):
        text = f"{name} was altered: an operation never changes its arguments"
        raise Mismatch(calling.ALTERED, name, text)


def _require_same(problem: str, first: Sequence, second: Sequence, size: float = 0.0) -> None:
    """Raise a Mismatch with the problem unless all floats agree, to rounding.

    What they are made of has this size: a gradient may be the difference of two weights.
    """
    one = flat(first)
    other = flat(second)
    largest = np.max(np.abs(one), initial=0.0, where=np.isfinite(one))
    allowed = np.finfo(one.dtype).eps * (1000 * largest + 16 * size)
    if one.shape != other.shape or not np.allclose(one, other, 0, allowed, equal_nan=True):
        raise Mismatch(calling.REPEATED, problem, problem)


def _judge(at: Argument, rng: np.random.Generator, kinks_excused: float) -> Iterator[Mismatch]:
    """Judge each direction; say where the numbers disagree most."""
    directions = list(_directions(at, rng))
    tried = len(directions)
    of_what = "entries" if at.x.size <= EVERY_ENTRY_UP_TO else "random directions"
    wrong, kinks, undecided = _judged(at, directions)
    if of_what != "entries" and kinks:
        entries = _entries(at.x, rng.choice(at.x.size, EVERY_ENTRY_UP_TO, replace=False))
        of_entries, kinks, undecided = _judged(at, entries)
        tried = len(wrong) + EVERY_ENTRY_UP_TO
        wrong += of_entries
    if wrong:
        worst = max(wrong, key=lambda one: abs(one[1].numeric - one[1].analytic))
        index, verdict = _trace(at, *worst)
        if verdict.kind == WRONG or (verdict.kind == AGREES and at.epsilon < SINGLE):
            yield _wrong_slope(at, index, verdict, f"{len(wrong)} of {tried} {of_what}")
    elif len(kinks) > max(1, int(kinks_excused * tried)):
        index, verdict = _trace(at, *kinks[0])
        text = f"{at.name}, shape {at.x.shape}, has a kink in {len(kinks)} of {tried} entries"
        slopes = f"such as {index}: its two slopes differ by {abs(verdict.jump):.6g}"
        advice = "too many to be excused: choose inputs away from kinks"
        yield Mismatch(differences.KINK, at.name, f"{text}, {slopes}\n    {advice}")
    elif kinks_excused < 1 and 2 * len(undecided) > tried:
        text = f"the gradient for {at.name}, shape {at.x.shape}, is undecided in {len(undecided)}"
        why = "differences of the value scatter too much: choose other inputs"
        yield Mismatch(differences.UNDECIDED, at.name, f"{text} of {tried} {of_what}\n    {why}")


def _wrong_slope(at: Argument, index: tuple[int, ...], verdict: Verdict, share: str) -> Mismatch:
    """What is wrong with one entry of a gradient, with both numbers."""
    what = f"the gradient for {at.name}"
    others = [f"wrong in {share}"]
    if verdict.rates:
        rates = ", ".join(f"{rate:.2f}" for rate in verdict.rates)
        others.append(f"Taylor's remainder falls with the powers {rates} of the step, not 2")
    if at.dy.size <= calling.WORTH_PRINTING:
        others.append(f"upstream gradient, flat: {calling.written(at.dy)}")
    first = f"{what}, shape {at.x.shape}, is wrong at index {index}"
    return Mismatch(calling.SLOPE, what, _both_numbers(first, verdict, *others))


def _judged(at: Argument, directions: Iterable[np.ndarray]) -> Iterator[list]:
    """(direction, verdict) of each direction that is wrong, has a kink, or is undecided."""
    judged = [(direction, at.judge(direction)) for direction in directions]
    for kind in (WRONG, differences.KINK, differences.UNDECIDED):
        yield [one for one in judged if one[1].kind == kind]


def _directions(at: Argument, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Every entry in turn; for a large array, random directions.

    A random direction covers entries whose contributions to the slope are of similar size.
    """
    if at.x.size <= EVERY_ENTRY_UP_TO:
        yield from _entries(at.x, range(at.x.size))
        return
    scale = differences.step_scale(at.x)
    contribution = np.abs(at.gradient) * scale
    decades = np.round(np.log10(np.maximum(contribution, 1e-30)) / 3)
    for decade in np.unique(decades):
        for _ in range(DIRECTIONS):
            yield rng.standard_normal(at.x.shape) * scale * (decades == decade)


def _entries(x: np.ndarray, entries: Iterable[int]) -> Iterator[np.ndarray]:
    """Directions of single entries, each as long as its entry is large."""
    scale = differences.step_scale(x)
    return (_restricted(scale, [entry]) for entry in entries)


def _restricted(direction: np.ndarray, entries: Sequence[int]) -> np.ndarray:
    part = np.zeros(direction.size)
    part[entries] = direction.ravel()[entries]
    return part.reshape(direction.shape)


def _trace(at: Argument, direction, verdict) -> tuple[tuple[int, ...], Verdict]:
    """Halve a failing direction until one entry is left; return its index and both numbers."""
    entries = np.flatnonzero(direction)
    while len(entries) > 1:
        halves = np.array_split(entries, 2)
        judged = [at.judge(_restricted(direction, half)) for half in halves]
        worse = max((0, 1), key=lambda i: abs(judged[i].numeric - judged[i].analytic))
        entries = halves[worse]
        verdict = judged[worse]
    index = tuple(map(int, np.unravel_index(entries[0], direction.shape)))
    numbers = np.array([verdict.numeric, verdict.analytic, verdict.jump]) / direction[index]
    return index, Verdict(verdict.kind, *numbers.tolist(), verdict.rates)


def _names(f: Callable, count: int) -> tuple[str, ...]:
    """The names of f's arguments, or their positions if the signature of f does not name them."""
    named: list[str] = []
    with suppress(TypeError, ValueError):
        parameters = inspect.signature(f).parameters.values()
        named = [p.name for p in parameters if p.kind <= p.POSITIONAL_OR_KEYWORD]
    return tuple(named[:count] if count <= len(named) else [f"argument {i}" for i in range(count)])
