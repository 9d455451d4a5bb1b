"""The classes of values and the memory layouts that arrays are tried with.

Ordinary entries are a shuffled even grid: distinct, never 0, and short to write down. The other
classes contain zeros, ties, numbers near 0, numbers that saturate, and arrays with a structure,
such as repeated or sorted slices.
"""

import math
from collections.abc import Callable

import numpy as np

ORDINARY = "ordinary"
THE_SAME = "the same array"

Draw = Callable[[np.random.Generator, tuple[int, ...], float], np.ndarray]
"""(rng, shape, reach) -> array, whose entries are mostly between -reach and reach."""
Change = Callable[[np.ndarray, np.random.Generator], np.ndarray]
"""(array, rng) -> the array changed along its first axis."""


def spread(rng: np.random.Generator, shape: tuple[int, ...], reach: float = 2.0) -> np.ndarray:
    """Distinct entries, none of them 0, evenly spaced between -reach and reach, shuffled."""
    count = math.prod(shape)
    even = count + count % 2
    grid = (2 * np.arange(even) + 1 - even) * (reach / max(even, 1))
    return rng.permutation(grid)[:count].reshape(shape)


def _choice_of(*numbers: float) -> Draw:
    """Entries that are some numbers times the reach."""
    return lambda rng, shape, reach: rng.choice(numbers, shape) * reach


def _along_an_axis(change: Change) -> Draw:
    """Ordinary entries, changed along an axis that is drawn."""

    def draw_along_axis(
        rng: np.random.Generator, shape: tuple[int, ...], reach: float
    ) -> np.ndarray:
        axis = int(rng.integers(len(shape)))
        array = np.moveaxis(spread(rng, shape, reach), axis, 0)
        return np.ascontiguousarray(np.moveaxis(change(array, rng), 0, axis))

    return draw_along_axis


def _random(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return rng.uniform(-reach, reach, shape)


def _near_ties(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return rng.choice([-1.0, 0.0, 0.5], shape) * reach + 1e-8 * spread(rng, shape)


def _tiny(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return spread(rng, shape) * rng.choice([1e-6, 1e-13])


def _positive(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return np.abs(spread(rng, shape, reach))


def _negative(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return -np.abs(spread(rng, shape, reach))


def _large(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return spread(rng, shape, 5 * reach)


def _offset(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return 1e4 + spread(rng, shape, reach)


MIXED_CLASSES = 10
"""So many of the first classes are mixed in the arrays of "mixed"."""


def _mixed(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    arrays = [draw(rng, shape, reach) for draw in list(VALUES.values())[:MIXED_CLASSES]]
    return np.choose(rng.integers(len(arrays), size=shape), arrays)


def _wide(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return spread(rng, shape, reach) * 10 ** rng.uniform(-9, 2.5, shape)


def _constant(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return np.full(shape, rng.uniform(-reach, reach))


def _identity(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    row, column = np.indices((1, *shape))[-2:, 0]
    return np.where(row == column, 1.0, 0.0)


def _insert_zeros(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return np.insert(array[1:], rng.integers(len(array)), 0, 0)


def _repeat_slices(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return array[np.arange(len(array)) // 2]


def _repeat_first_slice(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return array[np.zeros(len(array), int)]


def _make_symmetric(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return (array + array[::-1]) / 2


def _sort(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return np.sort(array, axis=0)


def _sort_downwards(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return np.sort(array, axis=0)[::-1]


VALUES: dict[str, Draw] = {
    ORDINARY: spread,
    "random": _random,
    "zeros": _choice_of(0.0),
    "ties": _choice_of(-1.0, -0.5, 0.5, 1.0),
    "signed zeros": _choice_of(0.0, -0.0, 0.5, -0.5),
    "near ties": _near_ties,
    "tiny": _tiny,
    "positive": _positive,
    "negative": _negative,
    "large": _large,
    "offset": _offset,
    "huge": _choice_of(-500.0, -500.0, -50.0, -15.0, 15.0, 50.0, 500.0, 500.0),
    "mixed": _mixed,
    "wide": _wide,
    "constant": _constant,
    "identity": _identity,
    "a slice of zeros": _along_an_axis(_insert_zeros),
    "repeated slices": _along_an_axis(_repeat_slices),
    "equal slices": _along_an_axis(_repeat_first_slice),
    "symmetric": _along_an_axis(_make_symmetric),
    "sorted": _along_an_axis(_sort),
    "sorted downwards": _along_an_axis(_sort_downwards),
    THE_SAME: spread,
}
"""The classes of values, the simplest first."""
EXTREME = _choice_of(-1e30, 1e30, 1e-30, -1e-30, 1.0)
"""Numbers whose squares float32 cannot hold, for operations that do not multiply them."""


def _every_other_entry(array: np.ndarray) -> np.ndarray:
    """A view of an array with a zero between any two entries."""
    return np.stack([array, np.zeros_like(array)], axis=-1)[..., 0]


def _backwards(array: np.ndarray) -> np.ndarray:
    """A view backwards along every axis longer than 1: one entry has no direction."""
    axes = tuple(axis for axis, size in enumerate(array.shape) if size > 1)
    return np.flip(np.flip(array, axes).copy(), axes)


def _last_axis_first(array: np.ndarray) -> np.ndarray:
    """A view of an array that has its last axis first in memory."""
    return np.moveaxis(np.moveaxis(array, -1, 0).copy(), 0, -1)


def _second_axis_first(array: np.ndarray) -> np.ndarray:
    """A view of an array whose first two axes are exchanged, such as frames before windows."""
    return array.swapaxes(0, 1).copy().swapaxes(0, 1) if array.ndim > 1 else array.copy()


LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    ORDINARY: np.ndarray.copy,
    "in Fortran order": lambda array: array.copy(order="F"),
    "every other entry": _every_other_entry,
    "reversed": _backwards,
    "last axis first": _last_axis_first,
    "second axis first": _second_axis_first,
    "read-only": lambda array: np.broadcast_to(array.copy(), array.shape),
    "broadcast": lambda array: np.broadcast_to(array[:1], array.shape),
}
"""The memory layouts that an array may have: none of them may change a result."""
