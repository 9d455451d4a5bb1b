"""Checks of the arrays of a model file, which anyone may have written."""

import json
from collections.abc import Mapping

import numpy as np

MAX_NUMBER = 1e6
"""Largest absolute value of a number in a model file, unless a reader states a smaller one."""


def json_object(arrays: Mapping[str, np.ndarray], name: str) -> dict:
    """The JSON object in the text array of that name; ValueError if the text is none."""
    value = json.loads(str(arrays[name]))
    if not isinstance(value, dict):
        raise ValueError(f"{name} is not a JSON object")
    return value


def numbers(
    arrays: Mapping[str, np.ndarray],
    name: str,
    shape: tuple[int, ...],
    least: float = -MAX_NUMBER,
    most: float = MAX_NUMBER,
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


def integer(arrays: Mapping[str, np.ndarray], name: str, least: int, most: int) -> int:
    """The whole number of that name; ValueError unless it is from `least` to `most`."""
    array = arrays[name]
    if array.shape != () or array.dtype.kind != "i" or not least <= array <= most:
        raise ValueError(f"{name} is not a whole number from {least} to {most}")
    return int(array)
