"""The gradient check: differences of the value are compared with what the pullback returns.

The slope of Σ dy ∘ f along an entry of an argument must equal the entry of the gradient that the
pullback returns for dy. This module handles arrays with too many entries to try each, float32 and
tuples; `differences` judges one direction.
"""

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from numpy_cae.verify.checks.calls import gradients_of
from numpy_cae.verify.checks.checked_function import (
    TOGETHER,
    CheckedFunction,
    OutputGradients,
    Upstream,
)
from numpy_cae.verify.checks.differences import (
    AGREES,
    SINGLE,
    SINGLE_TOLERANCE,
    WRONG,
    Argument,
    Verdict,
    step_scale,
)
from numpy_cae.verify.checks.leaves import all_leaves, copy_arrays, has_gradient
from numpy_cae.verify.checks.messages import WORTH_PRINTING, as_text, texts_that_differ
from numpy_cae.verify.checks.mismatch import KINK, SLOPE, UNDECIDED, Mismatch, require_shape

EVERY_ENTRY_UP_TO = 100
"""Arrays of at most this many entries are checked entry by entry."""

Judged = tuple[np.ndarray, Verdict]
"""A direction and the verdict on it."""


LINES_OF_FURTHER_PROBLEMS = 3
"""Of a second and further wrong gradient so many lines are printed: where, and both numbers."""


def check_gradients(
    f: Callable,
    *inputs: object,
    rng: np.random.Generator | None = None,
    tolerance: float = 1e-6,
    names: Sequence[str] | None = None,
    only: Sequence[str] | None = None,
) -> None:
    """Raise unless the pullback of f agrees with differences of the value, for every argument.

    docs/what_is_tried.md explains how steps are chosen, and how kinks and float32 are handled.

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
        Relative to the sizes of both numbers, and at least 1e-4 for float32. The value and the
        gradients of a second call may differ by as much.
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
    names = tuple(names) if names is not None else names_of_arguments(f, len(inputs))
    problems = find_wrong_gradients(f, inputs, names, rng, tolerance, only)
    if problems:
        lines = [str(problems[0])]
        for problem in problems[1:]:
            further = str(problem).splitlines()[:LINES_OF_FURTHER_PROBLEMS]
            parts = [" ".join(line.split()) for line in further]
            lines.append("also: " + ", ".join(parts))
        raise AssertionError("\n".join(lines))


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
    require_shape("the value", value, np.shape(y))
    (pulled,) = gradients_of(pullback(y), 1)
    require_shape("what the pullback returns", pulled, np.shape(x))
    forward = float(np.sum(value * y))
    backward = float(np.sum(x * pulled))
    scale = np.linalg.norm(value) * np.linalg.norm(y) + np.linalg.norm(x) * np.linalg.norm(pulled)
    if not abs(forward - backward) <= tolerance * scale:
        products = f"<A x, y> = {forward:.12g}, but <x, A' y> = {backward:.12g}"
        raise AssertionError(f"the pullback is not the adjoint: {products}")


KINKS_EXCUSED = 0.05
"""Kinks are excused in one entry of several, or in at most this share of the entries."""


def find_wrong_gradients(
    f: Callable,
    inputs: Sequence,
    names: Sequence[str],
    rng: np.random.Generator,
    tolerance: float = 1e-6,
    only: Sequence[str] | None = None,
    upstream: Upstream | None = None,
    kinks_excused: float = KINKS_EXCUSED,
) -> list[Mismatch]:
    """What is wrong with each gradient.

    `upstream` makes the upstream gradient of an output, by default random numbers. Kinks are
    excused in so large a share of the entries.
    """
    if not any(has_gradient(name, leaf) for name, leaf in all_leaves(inputs, names)):
        raise TypeError("no argument is an array of float64 or float32")
    if upstream is None:
        upstream = _random_upstream(rng)
    function = CheckedFunction(f, inputs, names, only, tolerance)
    of_outputs = function.gradients_by_output(upstream)
    problems: list[Mismatch] = []
    for output in of_outputs:
        suffix = f" from output {output.number}" if len(of_outputs) > 1 else ""
        together = _argument_of_all(function, output, tolerance)
        arguments = _arguments_of(function, output, together)
        for name, argument in arguments.items():
            if function.chooses(name):
                problems += _judge(replace(argument, name=name + suffix), rng, kinks_excused)
        if not problems and function.chooses(TOGETHER):
            if any(argument.is_computed_in_float32() for argument in arguments.values()):
                together = replace(together, epsilon=SINGLE, tolerance=SINGLE_TOLERANCE)
            problems += _judge_together(together)
    return problems


def _random_upstream(rng: np.random.Generator) -> Upstream:
    """Upstream gradients of random numbers."""
    return lambda output: rng.standard_normal(np.shape(output))


def _argument_of_all(
    function: CheckedFunction, output: OutputGradients, tolerance: float
) -> Argument:
    """All arrays that have a gradient as one argument, a row, for one output, in float64."""
    leaves = function.leaves
    wide = _in_float64(leaves, output)
    y = np.asarray(function.outputs(copy_arrays(wide))[0][output.number])
    if any(getattr(array, "dtype", None) == np.float32 for array in (*leaves, y)):
        tolerance = max(tolerance, SINGLE_TOLERANCE)
    places = _places_of(output)
    return Argument(
        TOGETHER,
        function.output_at(wide, places, output.number),
        x=_row(wide, places),
        dy=np.ravel(output.dy),
        here=np.ravel(y),
        gradient=_row(output.gradients, places),
        epsilon=float(np.finfo(y.dtype).eps),
        tolerance=tolerance,
        rounding=_row(output.rounding, places),
    )


def _arguments_of(
    function: CheckedFunction, output: OutputGradients, together: Argument
) -> dict[str, Argument]:
    """Each array that has a gradient by name, with the settings of all together."""
    wide = _in_float64(function.leaves, output)
    arguments = {}
    for place in _places_of(output):
        name, _ = function.named_leaves[place]
        shape = wide[place].shape
        arguments[name] = replace(
            together,
            name=name,
            f=function.output_at(wide, [place], output.number),
            x=_row(wide, [place]).reshape(shape),
            gradient=_row(output.gradients, [place]).reshape(shape),
            rounding=_row(output.rounding, [place]).reshape(shape),
        )
    return arguments


def _places_of(output: OutputGradients) -> list[int]:
    """The positions of the parts of the arguments that have a gradient."""
    return [place for place, gradient in enumerate(output.gradients) if gradient is not None]


def _in_float64(leaves: Sequence, output: OutputGradients) -> list:
    """The parts of the arguments, those with a gradient as float64."""
    wide = list(leaves)
    for place in _places_of(output):
        wide[place] = np.array(leaves[place], np.float64)
    return wide


def _row(arrays: Sequence, places: Sequence[int]) -> np.ndarray:
    """Some of the arrays in one row."""
    return np.concatenate([np.ravel(arrays[place]) for place in places])


EQUAL_ENTRIES = (1.7, 2.9)
"""Frequencies by which the step of an entry depends on its size."""


def _judge_together(argument: Argument) -> Iterator[Mismatch]:
    """Move each entry in proportion to itself and to a number that depends on its size alone.

    Along such a direction equal entries stay equal, so that a maximum of them has no kink.
    """
    if not np.any(argument.x):
        return
    for frequency in EQUAL_ENTRIES:
        direction = argument.x * (2 + np.sin(frequency * np.abs(argument.x))) / 8
        verdict = argument.judge(direction)
        if verdict.kind == WRONG:
            first = "where equal entries move by equal amounts, the gradients do not give the slope"
            last = "is a gradient given to each of several equal entries?"
            text = "\n    ".join([first, *_both_numbers(verdict), last])
            yield Mismatch(SLOPE, "the gradients together", text)
            return


NUMBER_DIGITS = 10
"""The two numbers of a wrong slope have at least this many digits."""


def _both_numbers(verdict: Verdict) -> list[str]:
    """The lines with the pullback's number and with that of differences."""
    numbers = texts_that_differ(verdict.analytic + 0, verdict.numeric + 0, NUMBER_DIGITS)
    by_pullback = f"by the pullback                      {numbers[0]}"
    by_differences = f"by central differences of the value  {numbers[1]}"
    return [by_pullback, by_differences]


def _judge(
    argument: Argument, rng: np.random.Generator, kinks_excused: float
) -> Iterator[Mismatch]:
    """Judge each direction; say where the numbers disagree most."""
    judged = _judge_directions(argument, _directions(argument, rng))
    number_judged = len(judged)
    wrong = _of_kind(WRONG, judged)
    of_what = "entries"
    if argument.x.size > EVERY_ENTRY_UP_TO:
        of_what = "random directions"
        if _of_kind(KINK, judged):  # a direction has the kinks of all entries
            chosen = rng.choice(argument.x.size, EVERY_ENTRY_UP_TO, replace=False)
            judged = _judge_directions(argument, _entries(argument.x, chosen))
            number_judged = len(wrong) + EVERY_ENTRY_UP_TO
            wrong += _of_kind(WRONG, judged)
    kinks = _of_kind(KINK, judged)
    undecided = _of_kind(UNDECIDED, judged)
    if wrong:
        index, verdict = _trace(argument, *_worst_of(wrong))
        if verdict.kind == WRONG or (verdict.kind == AGREES and argument.epsilon < SINGLE):
            share = f"wrong in {len(wrong)} of {number_judged} {of_what}"
            yield _wrong_slope(argument, index, verdict, share)
    elif len(kinks) > max(1, int(kinks_excused * number_judged)) or _are_all(
        kinks, number_judged, kinks_excused
    ):
        index, verdict = _trace(argument, *kinks[0])
        yield _too_many_kinks(argument, index, verdict, f"{len(kinks)} of {number_judged} entries")
    elif kinks_excused < 1 and 2 * len(undecided) > number_judged:
        first = f"the gradient for {argument.name}, shape {argument.x.shape}, is undecided in"
        last = "differences of the value scatter too much: choose other inputs"
        text = f"{first} {len(undecided)} of {number_judged} {of_what}\n    {last}"
        yield Mismatch(UNDECIDED, argument.name, text)


def _are_all(kinks: Sequence[Judged], number_judged: int, kinks_excused: float) -> bool:
    """Whether every entry is at a kink, so that any pullback would pass, where not all may be."""
    return kinks_excused < 1 and 0 < number_judged == len(kinks)


def _worst_of(wrong: Sequence[Judged]) -> Judged:
    """The direction in which both numbers differ most."""
    return max(wrong, key=lambda judged: abs(judged[1].numeric - judged[1].analytic))


def _wrong_slope(
    argument: Argument, index: tuple[int, ...], verdict: Verdict, share: str
) -> Mismatch:
    """What is wrong with one entry of a gradient, with both numbers."""
    subject = f"the gradient for {argument.name}"
    lines = [f"{subject}, shape {argument.x.shape}, is wrong at index {index}"]
    lines += [*_both_numbers(verdict), share]
    if verdict.rates:
        rates = ", ".join(f"{rate:.2f}" for rate in verdict.rates)
        lines.append(f"Taylor's remainder falls with the powers {rates} of the step, not 2")
    if argument.dy.size <= WORTH_PRINTING:
        lines.append(f"upstream gradient, flat: {as_text(argument.dy)}")
    return Mismatch(SLOPE, subject, "\n    ".join(lines))


def _too_many_kinks(
    argument: Argument, index: tuple[int, ...], verdict: Verdict, share: str
) -> Mismatch:
    """That there are too many kinks, and the slopes at one of them."""
    text = f"{argument.name}, shape {argument.x.shape}, has a kink in {share}"
    slopes = f"such as {index}: its two slopes differ by {abs(verdict.jump):.6g}"
    advice = "too many to be excused: choose inputs away from kinks"
    return Mismatch(KINK, argument.name, f"{text}, {slopes}\n    {advice}")


def _judge_directions(argument: Argument, directions: Iterable[np.ndarray]) -> list[Judged]:
    """The verdict on each direction."""
    return [(direction, argument.judge(direction)) for direction in directions]


def _of_kind(kind: str, judged: Iterable[Judged]) -> list[Judged]:
    """The directions with a verdict of this kind."""
    return [(direction, verdict) for direction, verdict in judged if verdict.kind == kind]


DIRECTIONS = 4
"""A larger array is checked along so many random directions for each size of entry."""


def _directions(argument: Argument, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Every entry in turn; for a large array, random directions.

    A random direction covers entries whose contributions to the slope are of similar size.
    """
    if argument.x.size <= EVERY_ENTRY_UP_TO:
        yield from _entries(argument.x, range(argument.x.size))
        return
    scale = step_scale(argument.x)
    contribution = np.abs(argument.gradient) * scale
    decades = np.round(np.log10(np.maximum(contribution, 1e-30)) / 3)
    for decade in np.unique(decades):
        for _ in range(DIRECTIONS):
            yield rng.standard_normal(argument.x.shape) * scale * (decades == decade)


def _entries(x: np.ndarray, entries: Iterable[int]) -> Iterator[np.ndarray]:
    """Directions of single entries, each as long as its entry is large."""
    scale = step_scale(x)
    return (_restrict(scale, [entry]) for entry in entries)


def _restrict(direction: np.ndarray, entries: Sequence[int] | np.ndarray) -> np.ndarray:
    """The direction in some of its entries, 0 in the others."""
    part = np.zeros(direction.size)
    part[entries] = direction.ravel()[entries]
    return part.reshape(direction.shape)


def _trace(
    argument: Argument, direction: np.ndarray, verdict: Verdict
) -> tuple[tuple[int, ...], Verdict]:
    """Halve a failing direction until one entry is left; return its index and both numbers."""
    entries = np.flatnonzero(direction)
    while len(entries) > 1:
        judged = []
        for half in np.array_split(entries, 2):
            half_verdict = argument.judge(_restrict(direction, half))
            judged.append((half, half_verdict))
        entries, verdict = _worst_of(judged)
    index = tuple(map(int, np.unravel_index(entries[0], direction.shape)))
    length = direction[index]
    numeric = float(verdict.numeric / length)
    analytic = float(verdict.analytic / length)
    jump = float(verdict.jump / length)
    return index, Verdict(verdict.kind, numeric, analytic, jump, verdict.rates)


def names_of_arguments(f: Callable, count: int) -> tuple[str, ...]:
    """The names of f's arguments, or their positions if the signature of f does not name them."""
    named: list[str] = []
    with suppress(TypeError, ValueError):
        for parameter in inspect.signature(f).parameters.values():
            if parameter.kind <= parameter.POSITIONAL_OR_KEYWORD:
                named.append(parameter.name)
    if len(named) < count:
        return tuple(f"argument {i}" for i in range(count))
    return tuple(named[:count])
