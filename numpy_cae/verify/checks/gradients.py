"""The gradient check: differences of the value are compared with what the pullback returns.

The slope of Σ dy ∘ f along an entry of an argument must equal the entry of the gradient that the
pullback returns for dy. `check_gradients` and `_slope_agrees` are the textbook check with one step.
The other functions handle arrays with too many entries to try each, float32 and tuples;
`differences` judges the directions that one step does not confirm.
"""

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from numpy_cae.verify.checks.call import (
    WORTH_PRINTING,
    call,
    copies,
    flat,
    gradients_of,
    is_float,
    parts,
    require_array,
    written,
)
from numpy_cae.verify.checks.differences import KINK, WRONG, Argument, Verdict, step_scale

EVERY_ENTRY_UP_TO = 100
DIRECTIONS = 4
KINKS_EXCUSED = 0.05
SINGLE_TOLERANCE = 1e-4
"""The smallest tolerance if an argument is float32."""


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
    places = [i for i, x in enumerate(inputs) if _is_differentiated(names[i], x)]
    if not places:
        raise TypeError("no argument is an array of float64 or float32")
    dys, gradients = _gradients_of_two_calls(f, inputs, names, places, rng)
    is_single = any(inputs[i].dtype == np.float32 for i in places)
    allowed = max(tolerance, SINGLE_TOLERANCE) if is_single else tolerance
    for argument in _arguments(f, inputs, names, places, dys, gradients):
        if only is None or argument.name in only:
            directions = list(_directions(argument, rng))
            doubtful = [v for v in directions if not _slope_agrees(argument, v, allowed)]
            if doubtful:
                _judge(argument, doubtful, len(directions), rng, allowed)


def _slope_agrees(at: Argument, direction: np.ndarray, tolerance: float) -> bool:
    """Whether the central difference along a direction confirms the gradient's number.

    A difference of 0 confirms nothing: the step may be too small to change the value.
    """
    # The errors are step² times the third derivative, and epsilon / step by rounding.
    step = np.cbrt(at.epsilon)
    ahead, behind = at.f(at.x + step * direction), at.f(at.x - step * direction)
    numeric = np.sum(at.dy * (ahead - behind)) / (2 * step)
    analytic = np.sum(at.gradient * direction)
    allowed = tolerance * max(abs(numeric), abs(analytic))
    return bool(numeric != 0 and abs(numeric - analytic) <= allowed)


def _arguments(
    f: Callable, inputs: Sequence, names: Sequence[str], places: Sequence[int], dys, gradients
) -> Iterator[Argument]:
    """Each argument with its gradient and f as a function of it alone, computed in float64."""
    wide = [x.astype(np.float64) if i in places else x for i, x in enumerate(inputs)]
    outputs = parts(call(f, copies(wide))[0])
    is_coarse = any(np.asarray(y).dtype == np.float32 for y in outputs)
    if is_coarse and all(inputs[i].dtype != np.float32 for i in places):
        raise AssertionError(
            "given float64, the value is float32\n"
            "the value is computed in float32, too coarse for its slope to be measured"
        )
    epsilon = float(np.finfo(np.float32 if is_coarse else np.float64).eps)
    for i, gradient in zip(places, gradients, strict=True):
        along = _function_of_one(f, wide, i)
        yield Argument(names[i], along, wide[i], flat(dys), flat(outputs), gradient, epsilon)


def _gradients_of_two_calls(
    f: Callable, inputs: Sequence, names: Sequence[str], places: Sequence[int], rng
) -> tuple[list, tuple]:
    """Random upstream gradients, and the gradients that the pullback returns for them.

    Raise unless these are gradients, no argument is altered, and a second call returns the same.
    """
    before = copies(inputs)
    value, pullback = call(f, inputs)
    is_tuple, outputs = isinstance(value, tuple | list), copies(parts(value))
    dys = [_upstream(y, rng) for y in outputs]

    def pulled_back(pullback: Callable) -> tuple:
        given = copies(dys)
        pulled = pullback(tuple(given) if is_tuple else given[0])
        _require_untouched(["the upstream gradient"] * len(dys), given, dys)
        if isinstance(pulled, tuple | list) and len(pulled) == len(inputs):
            return tuple(pulled[i] for i in places)
        return gradients_of(pulled, len(places))

    gradients = pulled_back(pullback)
    _require_untouched(names, inputs, before)
    for i, gradient in zip(places, gradients, strict=True):
        _require_gradient(names[i], inputs[i].shape, gradient)
    again, pullback = call(f, copies(before))
    _require_same("value", outputs, parts(again))
    _require_same("gradient", gradients, pulled_back(pullback))
    return dys, gradients


def _function_of_one(f: Callable, inputs: Sequence, position: int) -> Callable:
    """The outputs of f, flat, as a function of one argument."""

    def outputs_at(x: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            given = copies([*inputs[:position], x, *inputs[position + 1 :]])
            return flat(parts(f(*given)[0]))

    return outputs_at


def _is_differentiated(name: str, x: object) -> bool:
    if not isinstance(x, np.ndarray) or not np.issubdtype(x.dtype, np.inexact):
        return False
    if x.dtype not in (np.float64, np.float32):
        raise TypeError(f"{name} must be an array of float64 or float32, not of {x.dtype}")
    return True


def _upstream(value: object, rng: np.random.Generator) -> np.ndarray | None:
    """A random upstream gradient for one output, or None if the output has no floats."""
    if not is_float(value):
        return None
    return rng.standard_normal(np.shape(value)).astype(np.asarray(value).dtype)[()]


def _require_untouched(names: Sequence[str], arrays: Sequence, before: Sequence) -> None:
    for name, array, copy in zip(names, arrays, before, strict=True):
        if isinstance(array, np.ndarray) and not np.array_equal(array, copy, equal_nan=True):
            raise AssertionError(f"{name} was altered: an operation never changes its arguments")


def _require_gradient(name: str, shape: tuple[int, ...], gradient: object) -> None:
    """Raise unless a gradient is an array of finite real numbers in the shape of its argument."""
    require_array(f"the gradient for {name}", gradient)
    if np.shape(gradient) != shape:
        raise AssertionError(
            f"the gradient for {name} is shape {np.shape(gradient)}, expected shape {shape}, "
            f"that of {name}"
        )
    if np.iscomplexobj(gradient):
        raise AssertionError(f"the gradient for {name} is complex")
    if not np.all(np.isfinite(gradient)):
        index = tuple(np.argwhere(~np.isfinite(gradient))[0].tolist())
        raise AssertionError(f"the gradient for {name} is {gradient[index]} at index {index}")


def _require_same(what: str, first: Sequence, second: Sequence) -> None:
    """Raise unless a second call of f returned what the first did."""
    one, other = flat(first), flat(second)
    allowed = 1000 * np.finfo(one.dtype).eps * np.max(np.abs(one), initial=0.0)
    if one.shape != other.shape or not np.allclose(one, other, 0, allowed, equal_nan=True):
        raise AssertionError(
            f"called again, f returns another {what}: randomness comes in as an argument"
        )


def _judge(
    at: Argument, doubtful: list[np.ndarray], tried: int, rng: np.random.Generator, tolerance: float
) -> None:
    """Judge the directions that one step did not confirm; say where the numbers disagree most."""
    of_what = "entries" if at.x.size <= EVERY_ENTRY_UP_TO else "random directions"
    judged = [(direction, at.judge(direction, tolerance)) for direction in doubtful]
    if of_what != "entries" and any(verdict.kind == KINK for _, verdict in judged):
        entries = _entries(at.x, rng.choice(at.x.size, EVERY_ENTRY_UP_TO, replace=False))
        judged = [one for one in judged if one[1].kind == WRONG]
        tried = len(judged) + EVERY_ENTRY_UP_TO
        judged += [(direction, at.judge(direction, tolerance)) for direction in entries]
    wrong = [one for one in judged if one[1].kind == WRONG]
    kinks = [one for one in judged if one[1].kind == KINK]
    if wrong:
        worst = max(wrong, key=lambda one: abs(one[1].numeric - one[1].analytic))
        index, verdict = _trace(at, *worst, tolerance)
        given = f"\n    upstream gradient, flat: {written(at.dy)}"
        dy = given if at.dy.size <= WORTH_PRINTING else ""
        raise AssertionError(
            f"the gradient for {at.name}, shape {at.x.shape}, is wrong at index {index}\n"
            f"    by the pullback                      {verdict.analytic + 0:.10g}\n"
            f"    by central differences of the value  {verdict.numeric + 0:.10g}\n"
            f"    wrong in {len(wrong)} of {tried} {of_what}{dy}"
        )
    if len(kinks) > max(1, int(KINKS_EXCUSED * tried)):
        index, verdict = _trace(at, *kinks[0], tolerance)
        raise AssertionError(
            f"{at.name}, shape {at.x.shape}, has a kink in {len(kinks)} of {tried} "
            f"entries, such as {index}: its two slopes differ by {abs(verdict.jump):.6g}\n"
            "    too many to be excused: choose inputs away from kinks"
        )


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


def _trace(at: Argument, direction, verdict, tolerance) -> tuple[tuple[int, ...], Verdict]:
    """Halve a failing direction until one entry is left; return its index and both numbers."""
    entries = np.flatnonzero(direction)
    while len(entries) > 1:
        halves = np.array_split(entries, 2)
        judged = [at.judge(_restricted(direction, half), tolerance) for half in halves]
        worse = max((0, 1), key=lambda i: abs(judged[i].numeric - judged[i].analytic))
        entries, verdict = halves[worse], judged[worse]
    index = tuple(map(int, np.unravel_index(entries[0], direction.shape)))
    numbers = (verdict.numeric, verdict.analytic, verdict.jump)
    return index, Verdict(verdict.kind, *(number / direction[index] for number in numbers))


def _names(f: Callable, count: int) -> tuple[str, ...]:
    """The names of f's arguments, or their positions if the signature of f does not name them."""
    try:
        parameters = list(inspect.signature(f).parameters.values())
    except (TypeError, ValueError):
        parameters = []
    named = [p.name for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    if len(named) < count:
        return tuple(f"argument {i}" for i in range(count))
    return tuple(named[:count])
