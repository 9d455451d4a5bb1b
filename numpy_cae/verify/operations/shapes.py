"""Shapes written as text, such as "taps channels filters", and arguments drawn in them."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from numpy_cae.verify.operations.case import ORDINARY, Case, Sizes, simplest_case
from numpy_cae.verify.operations.values import EXTREME, THE_SAME, VALUES, spread

Arguments = Callable[[Case], dict[str, Any]]
"""(case) -> the arguments by name, in the order of the call."""
Values = tuple[float, float] | Callable[[np.random.Generator, tuple[int, ...]], np.ndarray]
"""The lowest and the highest number of an argument, or a function that draws it."""
LARGEST_DRAWN = 2.0
"""Ordinary entries are between this and its negative before a range of values is applied."""
LEADING_AXES = ("batch", "frames", "channels")
"""The names of the axes for which "..." stands, unless other axes have them."""


def draw_arrays(
    case: Case, rng: np.random.Generator, shapes: Mapping[str, tuple[int, ...]], reach: float = 2.0
) -> dict[str, np.ndarray]:
    """Arrays by name: all, or the one that the case names, are of its class of values."""
    draw = VALUES.get(case.get("values"), EXTREME)
    arrays: dict[str, np.ndarray] = {}
    first_of_shape: dict[tuple[int, ...], np.ndarray] = {}
    for name, shape in shapes.items():
        is_of_class = case.get("of") in (ORDINARY, name)
        arrays[name] = (draw if is_of_class else spread)(rng, shape, reach)
        if case.get("values") == THE_SAME:
            arrays[name] = first_of_shape.setdefault(shape, arrays[name])
    return arrays


def arguments_of(
    shapes: Mapping[str, str], values: Mapping[str, Values], dtype: type = np.float64
) -> Arguments:
    """Arguments whose shapes are sizes, such as w="taps channels filters".

    A size may be a number, a product or sum such as 2*frames or in+out, or "...", which is any
    number of axes. Numbers outside of the range that `values` states are replaced by its ends.
    Floats have the dtype.
    """
    leading = leading_axes(shapes)

    def draw_arguments(case: Case) -> dict[str, Any]:
        rng = case.rng()
        any_axes = " ".join(leading[: case.get("axes", 0)])
        shapes_of_case = {}
        for name, text in shapes.items():
            shapes_of_case[name] = shape_of(case, text.replace("...", any_axes))
        arrays = draw_arrays(case, rng, shapes_of_case)
        for name, range_or_draw in values.items():
            if callable(range_or_draw):
                arrays[name] = range_or_draw(rng, arrays[name].shape)
            else:
                arrays[name] = _scale_to(range_or_draw, arrays[name])
        for name, array in arrays.items():
            if array.dtype.kind == "f":
                arrays[name] = array.astype(dtype, copy=False)
        return arrays

    return draw_arguments


def _scale_to(ends: tuple[float, float], array: np.ndarray) -> np.ndarray:
    """The array with its entries scaled to a range."""
    low, high = ends
    steps = np.clip(array, -LARGEST_DRAWN, LARGEST_DRAWN)
    return np.clip((low + high) / 2 + (high - low) / 4 * steps, low, high)


def shape_of(case: Case, sizes: str) -> tuple[int, ...]:
    """The shape "batch 3*hidden 2" in a case."""
    return tuple(_size(text, case) for text in sizes.split())


def _size(text: str, case: Case) -> int:
    """The number that a size stands for in a case, such as 2*frames+1."""
    total = 0
    for term in text.split("+"):
        factors = [int(f) if f.isdigit() else case[f] for f in term.split("*")]
        total += math.prod(factors)
    return total


def names_in(shapes: Mapping[str, str]) -> list[str]:
    """The names of the sizes in shapes, in their order."""
    text = " ".join(shapes.values()).replace("...", " ").replace("*", " ").replace("+", " ")
    return [name for name in dict.fromkeys(text.split()) if not name.isdigit()]


def leading_axes(shapes: Mapping[str, str]) -> list[str]:
    """The sizes of the axes for which "..." may stand."""
    used = names_in(shapes)
    names = [name for name in LEADING_AXES if name not in used]
    return [*names, "2", "2"] if used else [*names, "2"]


def add_choice_of_array(sizes: Sizes, draw_arguments: Arguments) -> Sizes:
    """The sizes, and which array is of a class of values, if there are several."""
    arguments = draw_arguments(simplest_case(sizes))
    arrays = [name for name, array in arguments.items() if np.ndim(array)]
    return sizes if len(arrays) == 1 else {**sizes, "of": (ORDINARY, *arrays)}
