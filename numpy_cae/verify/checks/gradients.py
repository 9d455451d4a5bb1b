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

from numpy_cae.verify.checks.call import call, copies, flat, is_float, parts, require_finite
from numpy_cae.verify.checks.differences import (
    AGREES,
    SINGLE,
    SINGLE_TOLERANCE,
    UNDECIDED,
    WRONG,
    Argument,
    Verdict,
    step_scale,
)
from numpy_cae.verify.checks.leaves import all_leaves, gradients_of_leaves, is_array, rebuilt
from numpy_cae.verify.checks.mismatch import (
    ALTERED,
    DTYPE,
    KINK,
    REPEATED,
    SLOPE,
    Mismatch,
)
from numpy_cae.verify.checks.notes import conclude, file_of, noted
from numpy_cae.verify.checks.written import WORTH_PRINTING, written, written_apart

EVERY_ENTRY_UP_TO = 100
"""EVERY_ENTRY_UP_TO: arrays of at most so many entries are checked entry by entry."""
DIRECTIONS = 4
"""DIRECTIONS: a larger array is checked along so many random directions for each size of entry."""
EQUAL_ENTRIES = (1.7, 2.9)
"""EQUAL_ENTRIES: frequencies by which the step of an entry depends on its size."""
KINKS_EXCUSED = 0.05
"""KINKS_EXCUSED: kinks are excused in at most this share of the entries."""
AGAIN = (
    "called again with -4 times the upstream gradient, the pullback does not return -4 times the "
    "gradients: it is not linear, or keeps something between calls"
)
OTHERWISE = "called again, f returns another {}: randomness comes in as an argument"
COARSE = "given float64, the value is computed in float32, too coarse to measure its slope"
OVERWRITTEN = "the gradient that was returned first is overwritten by the second"
SUM = "the gradients from all outputs are not the sum of those from each"


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

    Warns
    -----
    RuntimeWarning
        If all gradients are right, but f gives a warning, such as an overflow.

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
    notes: list[str] = []
    with noted(notes, file_of(f)):
        problems = wrong_gradients(f, inputs, names, rng, tolerance, only)
    others = ("also: " + " ".join(str(problem).split()[:60]) for problem in problems[1:])
    conclude([*map(str, problems[:1]), *others], notes)


def wrong_gradients(
    f: Callable,
    inputs: Sequence,
    names: Sequence[str],
    rng: np.random.Generator,
    tolerance: float = 1e-6,
    only: Sequence[str] | None = None,
    upstream: Callable | None = None,
    kinks_excused: float = KINKS_EXCUSED,
    may_be_single: bool = False,
) -> list[Mismatch]:
    """What is wrong with each gradient.

    `upstream` makes the upstream gradient of an output, by default random numbers. Kinks are
    excused in so large a share of the entries. If f `may_be_single`, it may compute in float32.
    """
    if not any(is_array(*leaf) for leaf in all_leaves(inputs, names)):
        raise TypeError("no argument is an array of float64 or float32")
    upstream = upstream or (lambda output: rng.standard_normal(np.shape(output)))
    problems: list[Mismatch] = []
    if may_be_single:
        tolerance = _tolerance(f, inputs, tolerance)
    for argument in _arguments(f, inputs, names, upstream, tolerance, only):
        name = argument.name.partition(" from output ")[0]
        if only is None or {name, name.partition("[")[0]} & set(only):
            problems += _judge(argument, list(_directions(argument, rng)), rng, kinks_excused)
    return problems


def _tolerance(f: Callable, inputs: Sequence, tolerance: float) -> float:
    """The tolerance, or more where f returns float32."""
    outputs = parts(call(f, copies(inputs))[0])
    is_single = any(np.asarray(output).dtype == np.float32 for output in outputs)
    return max(tolerance, SINGLE_TOLERANCE) if is_single else tolerance


def wrong_slope_together(
    f: Callable, inputs: Sequence[np.ndarray], names: Sequence[str], upstream: Callable
) -> Mismatch | None:
    """What is wrong with all gradients together, along a direction that keeps equal entries equal.

    Each entry moves in proportion to itself and to a number that depends on its size alone.
    """
    tolerance = _tolerance(f, inputs, 1e-6)
    every = list(_arguments(f, inputs, names, upstream, tolerance))
    ends = np.cumsum([argument.x.size for argument in every])[:-1]
    shapes = [argument.x.shape for argument in every]

    def of_row(row: np.ndarray) -> np.ndarray:
        pieces = (part.reshape(of) for part, of in zip(np.split(row, ends), shapes, strict=True))
        return np.ravel(f(*pieces)[0])

    joined = np.concatenate([argument.x.ravel() for argument in every])
    gradients = np.concatenate([np.ravel(argument.gradient) for argument in every])
    together = replace(every[0], name=" and ".join(names), f=of_row, x=joined, gradient=gradients)
    if any(argument.is_computed_in_float32() for argument in every):
        together = replace(together, epsilon=SINGLE, tolerance=SINGLE_TOLERANCE)
    for frequency in EQUAL_ENTRIES:
        direction = joined * (2 + np.sin(frequency * np.abs(joined))) / 8
        verdict = together.judge(direction)
        if verdict.kind == WRONG:
            numbers = written_apart(verdict.analytic, verdict.numeric, 10)
            text = (
                "where equal entries move by equal amounts, the gradients do not give the slope\n"
                f"    by the pullback                      {numbers[0]}\n"
                f"    by central differences of the value  {numbers[1]}\n"
                "    is a gradient given to each of several equal entries?"
            )
            return Mismatch(SLOPE, "the gradients together", text)
    return None


def _arguments(
    f: Callable,
    inputs: Sequence,
    names: Sequence[str],
    upstream: Callable,
    tolerance: float,
    only: Sequence[str] | None = None,
) -> Iterator[Argument]:
    """Each array, with its gradient from each output and f as a function of it, in float64."""
    dys, pulled = _gradients_of_two_calls(f, inputs, names, upstream, only)
    named = all_leaves(inputs, names)
    places = [i for i, gradient in enumerate(next(iter(pulled.values()))) if gradient is not None]
    if any(getattr(leaf, "dtype", None) == np.float32 for _, leaf in named):
        tolerance = max(tolerance, SINGLE_TOLERANCE)
    wide = [np.array(x, np.float64) if i in places else x for i, (_, x) in enumerate(named)]
    outputs = parts(call(f, rebuilt(inputs, iter(copies(wide))))[0])
    is_coarse = any(np.asarray(y).dtype == np.float32 for y in outputs)
    if is_coarse and tolerance < SINGLE_TOLERANCE:
        raise Mismatch(DTYPE, "the value", COARSE)
    epsilon = float(np.finfo(np.float32 if is_coarse else np.float64).eps)
    for i in places:
        for k, gradients in pulled.items():
            name = named[i][0] + (f" from output {k}" if len(pulled) > 1 else "")
            along = _function_of_one(f, inputs, wide, i, k)
            both = np.ravel(dys[k]), np.ravel(outputs[k])
            yield Argument(name, along, wide[i], *both, gradients[i], epsilon, tolerance)


@dataclass(frozen=True)
class _Call:
    """One call of f, whose pullback is called with multiples of the upstream gradients."""

    inputs: Sequence
    names: Sequence[str]
    only: Sequence[str] | None  # the arguments whose gradients have to be finite
    dys: list  # an upstream gradient for each output, None for an output without floats
    value: object
    pullback: Callable

    def gradients(self, factors: Sequence[float]) -> list:
        """The gradient for each array; raise a Mismatch if the upstream gradient is altered."""
        scaled = [None if dy is None else a * dy for a, dy in zip(factors, self.dys, strict=True)]
        given = copies(scaled)
        has_several = isinstance(self.value, tuple | list)
        pulled = self.pullback(tuple(given) if has_several else given[0])
        for now, was in zip(given, scaled, strict=True):
            _require_untouched("the upstream gradient", now, was)
        gradients = gradients_of_leaves(self.inputs, self.names, pulled)
        for (name, _), gradient in zip(all_leaves(self.inputs, self.names), gradients, strict=True):
            if self.only is None or {name, name.partition("[")[0]} & set(self.only):
                require_finite(f"the gradient for {name}", gradient)
        return gradients


def _gradients_of_two_calls(
    f: Callable,
    inputs: Sequence,
    names: Sequence[str],
    upstream: Callable,
    only: Sequence[str] | None,
) -> tuple[list, dict[int, list]]:
    """Upstream gradients, and what the pullback returns for each of them, by output.

    Raise unless these are gradients, no argument is altered, a second call returns the same, and
    the pullback is proportional to the upstream gradient, one result independent of the next.
    """
    named = all_leaves(inputs, names)
    before = copies([x for _, x in named])
    value, pullback = call(f, inputs)
    outputs = copies(parts(value))
    for output in outputs:
        require_finite("the value", output)
    dys = [np.array(upstream(y), np.asarray(y).dtype)[()] if is_float(y) else None for y in outputs]
    first = _Call(inputs, names, only, dys, value, pullback)
    ones = [1.0] * len(dys)
    gradients = first.gradients(ones)
    kept = copies(gradients)
    for (name, leaf), was in zip(named, before, strict=True):
        _require_untouched(name, leaf, was)
    _require_linear(first, gradients, kept)
    value, pullback = call(f, rebuilt(inputs, iter(copies(before))))
    _require_same(OTHERWISE.format("value"), outputs, parts(value))
    again = replace(first, pullback=pullback)
    _require_same(OTHERWISE.format("gradient"), kept, again.gradients(ones))
    return dys, _of_each_output(first, kept)


def _require_linear(first: _Call, gradients: list, kept: list) -> None:
    """Raise unless -4 dy gives -4 times the gradients, and leaves the first ones as they were."""
    again = first.gradients([-4.0] * len(first.dys))
    arrays = [leaf for _, leaf in all_leaves(first.inputs, first.names) if is_float(leaf)]
    size = max((float(np.max(np.abs(array), initial=0.0)) for array in arrays), default=0.0)
    _require_same(AGAIN, [-4.0 * g for g in kept if g is not None], again, size)
    _require_same(OVERWRITTEN, kept, gradients)


def _of_each_output(first: _Call, kept: list) -> dict[int, list]:
    """The gradients from each output alone; raise unless their sum is that from all outputs."""
    places = [k for k, dy in enumerate(first.dys) if dy is not None]
    if len(places) == 1:
        return {places[0]: kept}
    alone = np.eye(len(first.dys))
    of_each = {k: copies(first.gradients(alone[k])) for k in places}
    terms_of_each = zip(*of_each.values(), strict=True)
    sums = [sum(terms) for terms in terms_of_each if terms[0] is not None]
    _require_same(SUM, kept, sums)
    return of_each


def _function_of_one(
    f: Callable, inputs: Sequence, leaves: list, place: int, output: int
) -> Callable:
    """One output of f, flat, as a function of one array."""

    def output_at(x: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            given = iter(copies([*leaves[:place], x, *leaves[place + 1 :]]))
            return np.ravel(parts(f(*rebuilt(inputs, given))[0])[output])

    return output_at


def _require_untouched(name: str, array: object, before: object) -> None:
    if isinstance(array, np.ndarray) and not np.array_equal(array, before, equal_nan=True):
        rule = "an operation never changes its arguments"
        raise Mismatch(ALTERED, name, f"{name} was altered: {rule}")


def _require_same(problem: str, first: Sequence, second: Sequence, size: float = 0.0) -> None:
    """Raise a Mismatch with the problem unless all floats agree, to rounding.

    What they are made of has this size: a gradient may be the difference of two weights.
    """
    one = flat(first)
    other = flat(second)
    allowed = np.finfo(one.dtype).eps * (1000 * np.max(np.abs(one), initial=0.0) + 16 * size)
    if one.shape != other.shape or not np.allclose(one, other, 0, allowed, equal_nan=True):
        raise Mismatch(REPEATED, problem, problem)


def _judge(
    at: Argument, directions: list, rng: np.random.Generator, kinks_excused: float
) -> Iterator[Mismatch]:
    """Judge each direction; say where the numbers disagree most."""
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
        text = (
            f"{at.name}, shape {at.x.shape}, has a kink in {len(kinks)} of {tried} "
            f"entries, such as {index}: its two slopes differ by {abs(verdict.jump):.6g}\n"
            "    too many to be excused: choose inputs away from kinks"
        )
        yield Mismatch(KINK, at.name, text)
    elif kinks_excused < 1 and 2 * len(undecided) > tried:
        text = f"the gradient for {at.name}, shape {at.x.shape}, is undecided in {len(undecided)}"
        why = "differences of the value scatter too much: choose other inputs"
        yield Mismatch(UNDECIDED, at.name, f"{text} of {tried} {of_what}\n    {why}")


def _wrong_slope(at: Argument, index: tuple[int, ...], verdict: Verdict, share: str) -> Mismatch:
    """What is wrong with one entry of a gradient, with both numbers."""
    what = f"the gradient for {at.name}"
    numbers = written_apart(verdict.analytic + 0, verdict.numeric + 0, 10)
    lines = [
        f"{what}, shape {at.x.shape}, is wrong at index {index}",
        f"by the pullback                      {numbers[0]}",
        f"by central differences of the value  {numbers[1]}",
        f"wrong in {share}",
    ]
    if verdict.rates:
        rates = ", ".join(f"{rate:.2f}" for rate in verdict.rates)
        lines.append(f"Taylor's remainder falls with the powers {rates} of the step, not 2")
    if at.dy.size <= WORTH_PRINTING:
        lines.append(f"upstream gradient, flat: {written(at.dy)}")
    return Mismatch(SLOPE, what, "\n    ".join(lines))


def _judged(at: Argument, directions: Iterable[np.ndarray]) -> Iterator[list]:
    """(direction, verdict) of each direction that is wrong, has a kink, or is undecided."""
    judged = [(direction, at.judge(direction)) for direction in directions]
    for kind in (WRONG, KINK, UNDECIDED):
        yield [one for one in judged if one[1].kind == kind]


def _directions(at: Argument, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Every entry in turn; for a large array, random directions.

    A random direction covers entries whose contributions to the slope are of similar size.
    """
    if at.x.size <= EVERY_ENTRY_UP_TO:
        yield from _entries(at.x, range(at.x.size))
        return
    scale = step_scale(at.x)
    contribution = np.abs(at.gradient) * scale
    decades = np.round(np.log10(np.maximum(contribution, 1e-30)) / 3)
    for decade in np.unique(decades):
        for _ in range(DIRECTIONS):
            yield rng.standard_normal(at.x.shape) * scale * (decades == decade)


def _entries(x: np.ndarray, entries: Iterable[int]) -> Iterator[np.ndarray]:
    """Directions of single entries, each as long as its entry is large."""
    scale = step_scale(x)
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
