"""Operations with pullbacks as projects published them, in NumPy, and as they were fixed.

Each module of `historical/` re-enacts a wrong gradient that a library really had, with the links to
the public thread and to the fix. Each module of `layers/` is a layer of a small project in NumPy,
right or wrong. An operation that was wrong takes `fixed`: whether to compute as the fixed version.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path

import numpy as np

SIZES = (6, 4, 5, 3, 2)
"""The names in the shapes stand for these, in their order, in checks of one point."""


@dataclass(frozen=True)
class PublishedOperation:
    """An operation with a pullback that a project published.

    Parameters
    ----------
    project, operation : str
    thread, fix : str
        Links to where it was published or reported, and to the fixed version.
    mistake : str
        What is wrong with the gradient; empty if nothing is.
    shapes : mapping of str to str
        The shape of each argument, such as {"x": "batch channels"}.
    function : (*arrays) -> (value, pullback)
        With a parameter `fixed` if there is a mistake.
    ranges : mapping of str to (low, high)
        The range of an argument, where it is not -2 to 2.
    dtypes : tuple of str
        The dtypes that the operation keeps.
    """

    project: str
    operation: str
    thread: str
    shapes: Mapping[str, str]
    function: Callable
    fix: str = ""
    mistake: str = ""
    ranges: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    dtypes: tuple[str, ...] = ("float64", "float32")

    @property
    def name(self) -> str:
        """The name of its module."""
        return self.function.__module__.rpartition(".")[-1]

    @property
    def is_layer(self) -> bool:
        """Whether it is a layer of a small project, which does not promise to keep float32."""
        return ".layers." in self.function.__module__

    @property
    def is_right(self) -> bool:
        """Whether it has no mistake."""
        return not self.mistake

    def version(self, fixed: bool) -> Callable:
        """The operation, wrong or fixed; one without a mistake as it is."""
        if self.is_right:
            return self.function

        def operation(*arrays):
            return self.function(*arrays, fixed=fixed)

        operation.__name__ = self.function.__name__
        return operation

    def inputs(self) -> tuple[np.ndarray, ...]:
        """Standard normal numbers: what the documentation of each library gives to its check."""
        rng = np.random.default_rng(0)
        names = dict.fromkeys(re.findall(r"[a-z]\w*", " ".join(self.shapes.values())))
        sizes = dict(zip(names, SIZES, strict=False))
        arrays = []
        for shape in self.shapes.values():
            arrays.append(rng.standard_normal([size_of(text, sizes) for text in shape.split()]))
        return tuple(arrays)


def size_of(text: str, sizes: Mapping[str, int]) -> int:
    """A size such as 2*frames."""
    return math.prod(sizes.get(factor) or int(factor) for factor in text.split("*"))


def historical_bugs() -> list[PublishedOperation]:
    """The wrong gradients of libraries, in the order of their names."""
    return _published("historical")


def layers() -> list[PublishedOperation]:
    """The layers of small projects, in the order of their names."""
    return _published("layers")


def _published(folder: str) -> list[PublishedOperation]:
    paths = sorted(Path(__file__).with_name(folder).glob("*.py"))
    modules = [import_module(f"studies.gradients.{folder}.{path.stem}") for path in paths]
    return [module.PUBLISHED for module in modules]


def in_memory_order(array: np.ndarray) -> np.ndarray:
    """The array as a kernel reads it that takes it for contiguous: the numbers behind its first.

    Where its memory ends, zeros follow.
    """
    owner = array
    while isinstance(owner.base, np.ndarray):
        owner = owner.base
    starts = [a.__array_interface__["data"][0] for a in (owner, array)]
    memory = owner.ravel(order="K")[(starts[1] - starts[0]) // array.itemsize :][: array.size]
    return np.append(memory, np.zeros(array.size - memory.size, array.dtype)).reshape(array.shape)
