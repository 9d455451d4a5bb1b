"""The memory layouts that an array may have: none of them may change a result."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def _contiguous(array: np.ndarray) -> np.ndarray:
    """contiguous arrays"""
    return array.copy()


def _fortran(array: np.ndarray) -> np.ndarray:
    """arrays in Fortran order"""
    return array.copy(order="F")


def _every_other(array: np.ndarray) -> np.ndarray:
    """every other entry of larger arrays"""
    larger = np.zeros((*array.shape[:-1], 2 * array.shape[-1]), dtype=array.dtype)
    larger[..., ::2] = array
    return larger[..., ::2]


def _reversed(array: np.ndarray) -> np.ndarray:
    """reversed views"""
    return array[::-1].copy()[::-1]


def _channels_first(array: np.ndarray) -> np.ndarray:
    """views of arrays whose last axis is first in memory"""
    return np.moveaxis(np.moveaxis(array, -1, 0).copy(), 0, -1)


def _read_only(array: np.ndarray) -> np.ndarray:
    """arrays that cannot be written"""
    array = array.copy()
    array.flags.writeable = False
    return array


LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "ordinary": _contiguous,
    "Fortran": _fortran,
    "every other": _every_other,
    "reversed": _reversed,
    "channels first": _channels_first,
    "read-only": _read_only,
}
