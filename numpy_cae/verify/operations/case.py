"""One example to try a property on: sizes, a class of values, and a seed.

A counterexample reads "batch 1, frames 2, values ties, seed 3". These determine the arrays.
"""

import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle, islice, product
from typing import Any

import numpy as np

from numpy_cae.verify.operations.values import ORDINARY

LARGE = 16
"""A size above this occurs in one case of a property only, together with small sizes."""
VERY_LARGE = 100
"""A size above this gets a case of its own, in which all other sizes are small."""

Option = int | str
"""A size, or a class such as "ties"."""
Sizes = Mapping[str, tuple]
"""The options of each size, and of each class such as "values"; the simplest option comes first."""


@dataclass(frozen=True)
class Case:
    """Sizes by name, such as (("batch", 1), ("values", "ties")), and the seed of the entries."""

    sizes: tuple[tuple[str, Option], ...]
    seed: int

    def __getitem__(self, name: str) -> Any:
        return dict(self.sizes)[name]

    def get(self, name: str, default: Option = ORDINARY) -> Any:
        """The size or class of this name; the default if the case has none."""
        return dict(self.sizes).get(name, default)

    def rng(self) -> np.random.Generator:
        return np.random.default_rng(self.seed)

    @property
    def is_plain(self) -> bool:
        """Whether differences decide: ordinary numbers and no large size.

        Elsewhere there are kinks, or slopes far below those of other entries.
        """
        if self.get("values") != ORDINARY or self.get("state") != ORDINARY:
            return False
        return not any(_is_large(size) for _, size in self.sizes)

    def with_option(self, name: str, option: Option) -> "Case":
        """The case with another option of a size or class that it has."""
        sizes = tuple((size, option if size == name else was) for size, was in self.sizes)
        return Case(sizes, self.seed)

    def __str__(self) -> str:
        unusual = [f"{name} {size}" for name, size in self.sizes if size != ORDINARY]
        return ", ".join([*unusual, f"seed {self.seed}"])


def simplest_case(sizes: Sizes) -> Case:
    """The first option of each size, and the seed 0."""
    return Case(tuple((name, options[0]) for name, options in sizes.items()), 0)


SEEDS = 10_000
"""The seed of a case is below this number."""
SEEDS_TRIED = 3
"""Seeds below this number are tried to make a counterexample simpler."""


def random_cases(
    name: str,
    sizes: Sizes,
    count: int,
    combined: Sequence[str],
    full_size_classes: Sequence[Mapping[str, str]],
) -> list[Case]:
    """At least `count` cases, reproducible from `name`, smallest arrays first.

    Small sizes and value classes occur equally often, large sizes once, and each combination of
    the sizes in `combined` once (twice if there are few). A very large size gets an additional
    case, in which everything else is simple. The last options of all sizes get one case for each
    of the classes in `full_size_classes` that the sizes have.
    """
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    mixed = _mixed_rows(rng, sizes, count, [size for size in combined if size in sizes])
    rows = [*mixed, *_simple_rows(sizes), *_full_size_rows(sizes, full_size_classes)]
    cases = [Case(tuple(row.items()), int(rng.integers(SEEDS_TRIED, SEEDS))) for row in rows]
    return sorted(cases, key=_count_entries)


def _mixed_rows(
    rng: np.random.Generator, sizes: Sizes, count: int, combined: Sequence[str]
) -> list[dict[str, Any]]:
    """Random sizes and classes, all equally often, and every combination of some of them."""
    combinations = list(product(*(sizes[size] for size in combined)))
    count = max(count, len(combinations), 2 * min(len(combinations), count))
    columns = {size: _column(rng, options, count) for size, options in sizes.items()}
    columns_combined = zip(*islice(cycle(combinations), count), strict=True)
    columns.update(zip(combined, map(list, columns_combined), strict=True))
    large = [(size, option) for size, option in _large_options(sizes) if option <= VERY_LARGE]
    for number, (size, option) in zip(rng.permutation(count), large, strict=False):
        columns[size][number] = option
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


SEVERAL_TAPS = 5
"""At least this many taps are several."""


def _simple_rows(sizes: Sizes) -> Iterator[dict[str, Any]]:
    """Rows in which what is not named here is as simple as it may be.

    These are frames at or just below a power of two with several taps, where a short FFT wraps
    around; and each very large size beside one of the two simplest of all others.
    """
    simplest = {name: options[0] for name, options in sizes.items()}
    for frames, taps in product(sizes.get("frames", ()), sizes.get("taps", ())):
        below = (1 << (frames - 1).bit_length()) - frames  # the next power of two
        if frames > SEVERAL_TAPS and below <= 2 and SEVERAL_TAPS <= taps <= LARGE:
            yield simplest | {"frames": frames, "taps": taps}
    numbers = _numbers_in(sizes)
    large = [(size, option) for size, option in _large_options(sizes) if option > VERY_LARGE]
    for number, (size, option) in enumerate(large):
        simple = {name: options[:2][number % 2 - 1] for name, options in numbers.items()}
        yield simplest | simple | {size: option}


def _full_size_rows(
    sizes: Sizes, full_size_classes: Sequence[Mapping[str, str]]
) -> Iterator[dict[str, Any]]:
    """A row with the last option of every size for each of the classes that the sizes have."""
    simplest = {name: options[0] for name, options in sizes.items()}
    last = {name: options[-1] for name, options in _numbers_in(sizes).items()}
    for classes in full_size_classes:
        if all(option in sizes.get(name, ()) for name, option in classes.items()):
            yield simplest | last | dict(classes)


def _large_options(sizes: Sizes) -> Iterator[tuple[str, int]]:
    """The names of sizes with each large option."""
    for size, options in sizes.items():
        for option in options:
            if _is_large(option):
                yield size, option


def _numbers_in(sizes: Sizes) -> dict[str, tuple]:
    """The sizes that are numbers, without the classes."""
    return {name: options for name, options in sizes.items() if isinstance(options[0], int)}


def _column(rng: np.random.Generator, options: Sequence, count: int) -> list:
    """`count` of the options that are not large, in random order, all equally often."""
    small = [option for option in options if not _is_large(option)] or options
    rounds = -(-count // len(small))
    order = np.concatenate([rng.permutation(len(small)) for _ in range(rounds)])
    return [small[i] for i in order[:count]]


def _is_large(option: Option) -> bool:
    return isinstance(option, int) and option > LARGE


def _count_entries(case: Case) -> int:
    """The product of all sizes."""
    return math.prod(size for _, size in case.sizes if isinstance(size, int))
