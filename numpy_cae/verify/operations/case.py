"""One example to try a property on: sizes, a class of values, and a seed.

A counterexample reads "batch 1, frames 2, values ties, seed 3". These determine the arrays.
Ordinary entries are a shuffled even grid: distinct, never 0, and short to write down. The other
classes contain zeros, ties, numbers near 0, numbers that saturate, and arrays with a structure,
such as repeated or sorted slices.
"""

import math
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle, islice, product

import numpy as np

SEEDS = 10_000
"""SEEDS: the seed of a case is below this number."""
SEEDS_TRIED = 3
"""SEEDS_TRIED: seeds below this number are tried to make a counterexample simpler."""
LARGE = 16
"""LARGE: a size above this occurs in one case of a property only, together with small sizes."""
SEVERAL_TAPS = 5
"""SEVERAL_TAPS: at least so many taps are several."""
VERY_LARGE = 100
"""VERY_LARGE: a size above this gets a case of its own, in which all other sizes are small."""
ORDINARY = "ordinary"
THE_SAME = "the same array"

Sizes = Mapping[str, tuple]
"""The options of each size, and of each class such as "values"; the simplest option comes first."""


@dataclass(frozen=True)
class Case:
    """Sizes by name, such as (("batch", 1), ("values", "ties")), and the seed of the entries."""

    sizes: tuple[tuple[str, int | str], ...]
    seed: int

    def __getitem__(self, name: str) -> int:
        return dict(self.sizes)[name]

    def get(self, name: str, default: int | str = ORDINARY) -> int | str:
        return dict(self.sizes).get(name, default)

    def rng(self) -> np.random.Generator:
        return np.random.default_rng(self.seed)

    def __str__(self) -> str:
        unusual = [f"{name} {size}" for name, size in self.sizes if size != ORDINARY]
        return ", ".join([*unusual, f"seed {self.seed}"])


def spread(rng: np.random.Generator, shape: tuple[int, ...], reach: float = 2.0) -> np.ndarray:
    """Distinct entries, none of them 0, evenly spaced between -reach and reach, shuffled."""
    count = math.prod(shape)
    even = count + count % 2
    grid = (2 * np.arange(even) + 1 - even) * (reach / max(even, 1))
    return rng.permutation(grid)[:count].reshape(shape)


def _chosen(*numbers: float) -> Callable[..., np.ndarray]:
    return lambda rng, shape, reach: rng.choice(numbers, shape) * reach


def _near_ties(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    return rng.choice([-1.0, 0.0, 0.5], shape) * reach + 1e-8 * spread(rng, shape)


def _identity(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    row, column = np.indices((1, *shape))[-2:, 0]
    return np.where(row == column, 1.0, 0.0)


def _along_an_axis(change: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
    """Ordinary entries, changed along an axis: (array, that axis first, and rng) -> array."""

    def drawn_along(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
        axis = rng.integers(len(shape))
        array = np.moveaxis(spread(rng, shape, reach), axis, 0)
        return np.ascontiguousarray(np.moveaxis(change(array, rng), 0, axis))

    return drawn_along


def _mixed(rng: np.random.Generator, shape: tuple[int, ...], reach: float) -> np.ndarray:
    arrays = [draw(rng, shape, reach) for draw in list(VALUES.values())[:10]]
    return np.choose(rng.integers(len(arrays), size=shape), arrays)


VALUES: dict[str, Callable[..., np.ndarray]] = {
    ORDINARY: spread,
    "random": lambda rng, shape, reach: rng.uniform(-reach, reach, shape),
    "zeros": _chosen(0.0),
    "ties": _chosen(-1.0, -0.5, 0.5, 1.0),
    "signed zeros": _chosen(0.0, -0.0, 0.5, -0.5),
    "near ties": _near_ties,
    "tiny": lambda rng, shape, reach: spread(rng, shape) * rng.choice([1e-6, 1e-13]),
    "positive": lambda rng, shape, reach: np.abs(spread(rng, shape, reach)),
    "negative": lambda rng, shape, reach: -np.abs(spread(rng, shape, reach)),
    "large": lambda rng, shape, reach: spread(rng, shape, 5 * reach),
    "offset": lambda rng, shape, reach: 1e4 + spread(rng, shape, reach),
    "huge": _chosen(-500.0, -500.0, -50.0, -15.0, 15.0, 50.0, 500.0, 500.0),
    "mixed": _mixed,
    "wide": lambda rng, shape, reach: spread(rng, shape, reach) * 10 ** rng.uniform(-9, 2.5, shape),
    "constant": lambda rng, shape, reach: np.full(shape, rng.uniform(-reach, reach)),
    "identity": _identity,
    "a slice of zeros": _along_an_axis(lambda a, rng: np.insert(a[1:], rng.integers(len(a)), 0, 0)),
    "repeated slices": _along_an_axis(lambda array, rng: array[np.arange(len(array)) // 2]),
    "equal slices": _along_an_axis(lambda array, rng: array[np.zeros(len(array), int)]),
    "symmetric": _along_an_axis(lambda array, rng: (array + array[::-1]) / 2),
    "sorted": _along_an_axis(lambda array, rng: np.sort(array, axis=0)),
    "sorted downwards": _along_an_axis(lambda array, rng: np.sort(array, axis=0)[::-1]),
    THE_SAME: spread,
}
"""The classes of values, the simplest first: (rng, shape, reach) -> array."""
EXTREME = _chosen(-1e30, 1e30, 1e-30, -1e-30, 1.0)
"""Numbers whose squares float32 cannot hold, for operations that do not multiply them."""


def _reversed(array: np.ndarray) -> np.ndarray:
    """A view backwards along every axis longer than 1: one entry has no direction."""
    axes = tuple(axis for axis, size in enumerate(array.shape) if size > 1)
    return np.flip(np.flip(array, axes).copy(), axes)


def _second_axis_first(array: np.ndarray) -> np.ndarray:
    """A view of an array whose first two axes are exchanged, such as frames before windows."""
    return array.swapaxes(0, 1).copy().swapaxes(0, 1) if array.ndim > 1 else array.copy()


LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    ORDINARY: np.ndarray.copy,
    "in Fortran order": lambda array: array.copy(order="F"),
    "every other entry": lambda array: np.stack([array, np.zeros_like(array)], axis=-1)[..., 0],
    "reversed": _reversed,
    "last axis first": lambda array: np.moveaxis(np.moveaxis(array, -1, 0).copy(), 0, -1),
    "second axis first": _second_axis_first,
    "read-only": lambda array: np.broadcast_to(array.copy(), array.shape),
    "broadcast": lambda array: np.broadcast_to(array[:1], array.shape),
}
"""The memory layouts that an array may have: none of them may change a result."""


def drawn(case: Case, rng: np.random.Generator, reach: float = 2.0, **shapes) -> dict:
    """Arrays by name: all, or the one that the case names, are of its class of values."""
    draw = VALUES.get(case.get("values"), EXTREME)
    arrays: dict[str, np.ndarray] = {}
    of_shape: dict[tuple[int, ...], np.ndarray] = {}
    for name, shape in shapes.items():
        special = case.get("of") in (ORDINARY, name)
        arrays[name] = (draw if special else spread)(rng, shape, reach)
        if case.get("values") == THE_SAME:
            arrays[name] = of_shape.setdefault(shape, arrays[name])
    return arrays


def random_cases(
    name: str, sizes: Sizes, count: int, combined: Sequence[str], together: Sequence[Mapping]
) -> list[Case]:
    """At least `count` cases, reproducible from `name`, smallest arrays first.

    Small sizes and value classes occur equally often, large sizes once, and each combination of
    the sizes in `combined` once (twice if there are few). A very large size gets an additional
    case, in which everything else is simple. The last options of all sizes get one case for each
    of the classes in `together` that the sizes have.
    """
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    mixed = _mixed_rows(rng, sizes, count, [size for size in combined if size in sizes])
    rows = [*mixed, *_further_rows(sizes, together)]
    cases = [Case(tuple(row.items()), int(rng.integers(SEEDS_TRIED, SEEDS))) for row in rows]
    return sorted(cases, key=_entries)


def _mixed_rows(
    rng: np.random.Generator, sizes: Sizes, count: int, combined: Sequence[str]
) -> Iterator[dict]:
    """Random sizes and classes, all equally often, and every combination of some of them."""
    every = list(product(*(sizes[size] for size in combined)))
    count = max(count, len(every), 2 * min(len(every), count))
    columns = {size: _column(rng, options, count) for size, options in sizes.items()}
    combinations = zip(*islice(cycle(every), count), strict=True)
    columns.update(zip(combined, map(list, combinations), strict=True))
    large = [(size, option) for size in sizes for option in sizes[size] if _is_large(option)]
    with_small = [(size, option) for size, option in large if option <= VERY_LARGE]
    for number, (size, option) in zip(rng.permutation(count), with_small, strict=False):
        columns[size][number] = option
    for row in zip(*columns.values(), strict=True):
        yield dict(zip(columns, row, strict=True))


def _further_rows(sizes: Sizes, together: Sequence[Mapping]) -> Iterator[dict]:
    """Rows in which what is not named here is as simple as it may be.

    These are frames at or just below a power of two with several taps, where a short FFT wraps
    around; each very large size beside one of the two simplest of all others; and all last sizes.
    """
    first = {name: options[0] for name, options in sizes.items()}
    numbers = {name: options for name, options in sizes.items() if isinstance(options[0], int)}
    for frames, taps in product(sizes.get("frames", ()), sizes.get("taps", ())):
        below = (1 << (frames - 1).bit_length()) - frames  # the next power of two
        if frames > SEVERAL_TAPS and below <= 2 and SEVERAL_TAPS <= taps <= LARGE:
            yield first | {"frames": frames, "taps": taps}
    large = [(size, option) for size in numbers for option in numbers[size] if option > VERY_LARGE]
    for number, (size, option) in enumerate(large):
        simple = {name: options[:2][number % 2 - 1] for name, options in numbers.items()}
        yield first | simple | {size: option}
    last = {name: options[-1] for name, options in numbers.items()}
    for classes in together:
        if all(option in sizes.get(name, ()) for name, option in classes.items()):
            yield first | last | dict(classes)


def _column(rng: np.random.Generator, options: Sequence, count: int) -> list:
    """`count` of the options that are not large, in random order, all equally often."""
    small = [option for option in options if not _is_large(option)] or options
    order = [rng.permutation(len(small)) for _ in range(-(-count // len(small)))]
    return [small[i] for i in np.concatenate(order)[:count]]


def _is_large(option: int | str) -> bool:
    return isinstance(option, int) and option > LARGE


def _entries(case: Case) -> int:
    return math.prod(size for _, size in case.sizes if isinstance(size, int))
