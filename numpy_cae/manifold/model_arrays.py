"""Checks of a model's arrays, which are plain numbers, before they are used."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, one_line
from numpy_cae.training.divergence import ADVICE, LARGEST_WEIGHT

Arrays = Mapping[str, np.ndarray]
SMALLEST = 1e-6
"""Smallest factor and smallest deviation by which features may be divided."""
MAX_NUMBER = LARGEST_WEIGHT
"""Largest absolute value of a number in a model file, unless a reader states a smaller one."""
MAX_LENGTH = 10.0
"""Longest bone (m)."""
MAX_RATE = 1000.0
"""Most frames a second."""
MAX_FRAMES = 100_000
"""Longest window or clip that a file may state."""


def read_numbers(
    arrays: Arrays, name: str, shape: tuple, least: float = -MAX_NUMBER, most: float = MAX_NUMBER
) -> np.ndarray:
    """The array of that name; ValueError unless it has this shape and holds floating-point numbers
    of at most 64 bits from `least` to `most`."""
    array = arrays[name]
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if array.dtype.kind != "f" or array.dtype.itemsize > 8 or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} holds values that are not finite numbers")
    if array.size and not least <= float(array.min()) <= float(array.max()) <= most:
        raise ValueError(f"{name} holds values that are not from {least:g} to {most:g}")
    return array


def read_integer(arrays: Arrays, name: str, least: int, most: int) -> int:
    """The whole number of that name; ValueError unless it is from `least` to `most`."""
    array = arrays[name]
    if array.shape != () or array.dtype.kind != "i" or not least <= array <= most:
        raise ValueError(f"{name} is not a whole number from {least} to {most}")
    return int(array)


def require_loadable(
    read: Callable[[dict[str, np.ndarray]], object], arrays: dict[str, np.ndarray], path: str | Path
) -> None:
    """Raise ModelFileError, before anything is written, if a file of these arrays could not be
    loaded; `read` makes a manifold of the arrays of a file."""
    try:
        read(arrays)
        read_numbers(arrays, "rate", (), 1.0, MAX_RATE)
    except ValueError as error:
        problem = f"not written, since it could not be loaded: {one_line(error)}"
        advice = f"if the training diverged, {ADVICE}"
        raise ModelFileError(f"{path}: {problem}; {advice}") from None
