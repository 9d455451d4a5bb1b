"""Model files as plain arrays: what every kind of them is read and checked by."""

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


MOST = 200
"""Times its own size that a model unpacks to: text and biases of zero pack well, weights hardly."""

_UNREADABLE = (
    ValueError,
    EOFError,
    KeyError,
    TypeError,
    AttributeError,
    IndexError,
    SyntaxError,
    RuntimeError,  # encrypted; NotImplementedError, packed in another way, is one too
    MemoryError,
    OverflowError,
    struct.error,
    tokenize.TokenError,
    zipfile.BadZipFile,
    zlib.error,
)


class ModelFileError(NumpyCaeError, ValueError):
    """A model file that cannot be used as it stands."""


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
        arrays = _arrays(Path(path))
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


def _arrays(path: Path) -> dict[str, np.ndarray]:
    """Every array of the file. `np.load` believes a header that says how large an array is; here it
    is held against the bytes that are there, and those against the size of the file, first.
    """
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        if sum(info.file_size for info in archive.infolist()) > MOST * (path.stat().st_size + 4096):
            raise ValueError("unpacks to more than any model")
        for info in archive.infolist():
            with archive.open(info) as file:
                version = np.lib.format.read_magic(file)
                if version != (1, 0):
                    raise ValueError("an array of another form")
                shape, _, dtype = np.lib.format.read_array_header_1_0(file)
                if dtype.hasobject or math.prod(shape) * dtype.itemsize != (
                    info.file_size - file.tell()
                ):
                    raise ValueError("an array of another size than its header says")
            with archive.open(info) as file:
                name = info.filename.removesuffix(".npy")
                arrays[name] = np.lib.format.read_array(file, allow_pickle=False)
    return arrays


def text(arrays: dict[str, np.ndarray], name: str) -> dict:
    """The array of that name as a text of JSON that holds an object; else ValueError."""
    found = json.loads(str(arrays[name]))
    if not isinstance(found, dict):
        raise ValueError(f"{name} is no JSON object")
    return found


def checked(arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """The array of that name if it has the shape and holds finite numbers; else ValueError."""
    array = arrays[name]
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if array.dtype.kind != "f" or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} holds values that are not finite numbers")
    return array


def positive(arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """The same, its numbers above 0."""
    array = checked(arrays, name, shape)
    if np.any(array <= 0):
        raise ValueError(f"{name} holds values that are not above 0")
    return array


def whole(arrays: dict[str, np.ndarray], name: str, least: int, most: int) -> int:
    """The whole number of that name if it is from `least` to `most`; else ValueError."""
    array = arrays[name]
    if array.shape != () or array.dtype.kind != "i" or not least <= array <= most:
        raise ValueError(f"{name} is not a whole number from {least} to {most}")
    return int(array)
