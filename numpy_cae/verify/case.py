"""One example to try a property on: a few sizes and a seed.

Hypothesis draws and shrinks the sizes, so that a counterexample reads "batch 1, frames 2, taps 3".
The arrays follow from them and the seed. Their entries are a shuffled even grid: distinct and never
0, so that no pair ties and no entry is at a kink, and short to write down.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy_cae.verify.property import Property

WORTH_PRINTING = 24


@dataclass(frozen=True)
class Case:
    """Sizes by name, such as (("batch", 1), ("frames", 4)), and the seed of the entries."""

    sizes: tuple[tuple[str, int], ...]
    seed: int

    def __getitem__(self, name: str) -> int:
        return dict(self.sizes)[name]

    def rng(self) -> np.random.Generator:
        return np.random.default_rng(self.seed)

    def __str__(self) -> str:
        return ", ".join(f"{name} {size}" for name, size in self.sizes) + f", seed {self.seed}"


def spread(rng: np.random.Generator, shape: tuple[int, ...], reach: float = 2.0) -> np.ndarray:
    """Distinct entries, none of them 0, evenly spaced between -reach and reach, shuffled."""
    count = int(np.prod(shape))
    even = count + count % 2
    grid = (2 * np.arange(even) + 1 - even) * (reach / max(even, 1))
    return rng.permutation(grid)[:count].reshape(shape)


def described(name: str, case: Case, arguments: Mapping[str, object]) -> str:
    """A case of an operation or exercise with its arrays; if they are long, a call to get them."""
    arrays = [a for a in arguments.values() if isinstance(a, np.ndarray)]
    if sum(a.size for a in arrays) > WORTH_PRINTING:
        numbers = ", ".join(f"{size}={number}" for size, number in case.sizes)
        return f'{case}\nexample("{name}", {numbers}, seed={case.seed})'
    lines = [f"{argument} = {_written(value)}" for argument, value in arguments.items()]
    return "\n".join([str(case), *lines])


def example_of(stated: Property, seed: int, sizes: Mapping[str, int]) -> dict[str, object]:
    """The arguments of a case of a property; a ValueError if it has other sizes than these."""
    if set(sizes) != set(stated.sizes):
        known, got = ", ".join(stated.sizes), ", ".join(sizes)
        raise ValueError(f"{stated.operation} has the sizes {known}, got {got}")
    return stated.arguments(Case(tuple(sizes.items()), seed))


def _written(value: object) -> str:
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.size == 0:
        return f"np.empty({value.shape})"
    return str((value if value.dtype == bool else np.round(value, 4)).tolist())
