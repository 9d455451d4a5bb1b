"""Files of named arrays (.npz): models and checkpoints are written, read and checked here."""

from __future__ import annotations

import io
import json
import math
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.errors import NumpyCaeError

Model = TypeVar("Model")


MAX_EXPANSION = 200
"""Times its own size that a file may unpack to: text and zeros pack well, weights hardly."""

_UNREADABLE = (
    ValueError,
    EOFError,
    KeyError,
    TypeError,
    AttributeError,
    IndexError,
    SyntaxError,
    RuntimeError,  # encrypted, or (NotImplementedError) an unknown compression
    MemoryError,
    OverflowError,
    struct.error,
    tokenize.TokenError,
    zipfile.BadZipFile,
    zlib.error,
)


class ModelFileError(NumpyCaeError, ValueError):
    """A model file that cannot be used."""


def save_arrays(arrays: dict[str, np.ndarray], path: str | Path, compressed: bool = True) -> None:
    """Write the arrays as `.npz`, atomically.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    # In memory first: an archive that Ctrl-C leaves open writes its end when it is collected, and
    # would find the file closed.
    archive = io.BytesIO()
    save: Callable = np.savez_compressed if compressed else np.savez
    save(archive, **arrays)
    with atomic_write(path) as temporary:
        temporary.write_bytes(archive.getbuffer())


def load_arrays(
    path: str | Path, readers: Mapping[str, Callable[[dict[str, np.ndarray]], Model]]
) -> Model:
    """Read what `save_arrays` wrote and make a model of it.

    Parameters
    ----------
    path : path
    readers : mapping of format to function (dict of arrays) -> model
        For each accepted value of the array `format`. A KeyError, ValueError or TypeError that the
        function raises becomes a `ModelFileError`.

    Raises
    ------
    ModelFileError
        If the file is missing, has another format, or its arrays do not fit together.
    """
    try:
        arrays = _read_arrays(Path(path))
    except OSError as error:
        raise ModelFileError(f"{path}: {error.strerror or error}") from None
    except _UNREADABLE:
        raise ModelFileError(f"{path}: not a model that `numpy-cae train` wrote") from None
    found = str(arrays.get("format", "no model"))
    if found not in readers:
        expected = " or ".join(map(repr, readers))
        raise ModelFileError(
            f"{path}: its format is {found[:80]!r}, expected {expected}; make the file again with "
            "this version"
        )
    try:
        return readers[found](arrays)
    except (KeyError, ValueError, TypeError, IndexError, RecursionError) as error:
        problem = f"it has no {error}" if isinstance(error, KeyError) else str(error)
        raise ModelFileError(f"{path}: {problem[:500]}") from None


def _read_arrays(path: Path) -> dict[str, np.ndarray]:
    """Every array of the file. `np.load` trusts the size of an array that its header states; here
    it is first compared with the bytes that are there, and those with the size of the file.
    """
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        limit = MAX_EXPANSION * (path.stat().st_size + 4096)
        if sum(info.file_size for info in archive.infolist()) > limit:
            raise ValueError("unpacks to more than any model")
        for info in archive.infolist():
            with archive.open(info) as file:
                version = np.lib.format.read_magic(file)
                if version != (1, 0):
                    raise ValueError("an array in another format")
                shape, _, dtype = np.lib.format.read_array_header_1_0(file)
                if dtype.hasobject or math.prod(shape) * dtype.itemsize != (
                    info.file_size - file.tell()
                ):
                    raise ValueError("the size of an array differs from its header")
            with archive.open(info) as file:
                name = info.filename.removesuffix(".npy")
                arrays[name] = np.lib.format.read_array(file, allow_pickle=False)
    return arrays


def text(arrays: dict[str, np.ndarray], name: str) -> dict:
    """The JSON object in the text array of that name; ValueError if it is none."""
    found = json.loads(str(arrays[name]))
    if not isinstance(found, dict):
        raise ValueError(f"{name} is not a JSON object")
    return found


def checked(arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """The array of that name; ValueError unless it has this shape and holds finite numbers."""
    array = arrays[name]
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if array.dtype.kind != "f" or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} holds values that are not finite numbers")
    return array


def positive(arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """As `checked`, and ValueError unless all numbers are above 0."""
    array = checked(arrays, name, shape)
    if np.any(array <= 0):
        raise ValueError(f"{name} holds values that are not above 0")
    return array


def whole(arrays: dict[str, np.ndarray], name: str, least: int, most: int) -> int:
    """The whole number of that name; ValueError unless it is from `least` to `most`."""
    array = arrays[name]
    if array.shape != () or array.dtype.kind != "i" or not least <= array <= most:
        raise ValueError(f"{name} is not a whole number from {least} to {most}")
    return int(array)
