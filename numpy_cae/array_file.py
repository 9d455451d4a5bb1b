"""Files of named arrays (.npz): models and checkpoints are written, read and checked here."""

import hashlib
import io
import json
import math
import zipfile
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import TypeVar

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.errors import NumpyCaeError

Model = TypeVar("Model")

DIGEST = "digest"
"""The array with the digest of all others."""
FREE_BYTES, MAX_EXPANSION = 1 << 22, 8
"""A file may unpack to so many bytes, and to so many times its own size more: weights hardly
compress."""
MAX_TEXT = 10_000_000
"""Characters of a text array."""
MAX_NUMBER = 1e6
"""Absolute value of the numbers in a model file, unless something narrower is stated."""


class ModelFileError(NumpyCaeError, ValueError):
    """A model file that cannot be used."""


def save_arrays(arrays: dict[str, np.ndarray], path: str | Path, compressed: bool = True) -> None:
    """Write the arrays and their digest as `.npz`, atomically.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    # In memory first: an archive that Ctrl-C leaves open writes its end when it is collected, and
    # would find the file closed.
    archive = io.BytesIO()
    save: Callable = np.savez_compressed if compressed else np.savez
    save(archive, **arrays, **{DIGEST: np.array(digest_of(arrays))})
    with atomic_write(path) as temporary:
        temporary.write_bytes(archive.getbuffer())


def load_arrays(
    path: str | Path,
    readers: Mapping[str, Callable[[dict[str, np.ndarray]], Model]],
    undigested: Collection[str] = (),
) -> Model:
    """Read what `save_arrays` wrote and make a model of it.

    Parameters
    ----------
    path : path
    readers : mapping of format to function (dict of arrays) -> model
        For each accepted value of the array `format`. Any exception that the function raises
        becomes a `ModelFileError`.
    undigested : collection of str
        Formats of earlier versions, whose files have no digest.

    Raises
    ------
    ModelFileError
        If the file is missing, too large, has another format, was changed after it was written, or
        its arrays do not fit together.
    """
    path = Path(path)
    try:
        arrays = _read_arrays(path)
    except ModelFileError:
        raise
    except OSError as error:
        raise ModelFileError(f"{path}: {error.strerror or error}") from None
    except Exception:  # zipfile, zlib and NumPy raise a dozen kinds for damaged bytes
        raise ModelFileError(f"{path}: not a model that `numpy-cae train` wrote") from None
    try:
        if "format" not in arrays:
            raise ValueError("not a model that `numpy-cae train` wrote")
        found = word(arrays, "format")
        if found not in readers:
            expected = " or ".join(map(repr, readers))
            raise ValueError(
                f"its format is {found[:80]!r}, expected {expected}; make the file again with this "
                "version"
            )
        if found not in undigested and word(arrays, DIGEST) != digest_of(arrays):
            raise ValueError(
                "was changed after it was written: its digest is another; make it again"
            )
        return readers[found](arrays)
    except Exception as error:  # the arrays may hold anything
        problem = f"it has no {error}" if isinstance(error, KeyError) else str(error) or repr(error)
        problem = " ".join(problem.split())
        raise ModelFileError(f"{path}: {problem[:500]}") from None


def digest_of(arrays: Mapping[str, np.ndarray]) -> str:
    """Of the names, shapes, dtypes and values of all arrays but `DIGEST`."""
    digest = hashlib.blake2b(digest_size=16)
    for name in sorted(set(arrays) - {DIGEST}):
        array = np.asarray(arrays[name])
        digest.update(repr((name, array.shape, array.dtype.str)).encode())
        digest.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    return digest.hexdigest()


def _read_arrays(path: Path) -> dict[str, np.ndarray]:
    """Every array of the file. `np.load` trusts the size of an array that its header states; here
    it is first compared with the bytes that are there, and those with the size of the file.
    """
    if path.exists() and not path.is_file():
        raise ModelFileError(f"{path}: is not a regular file")
    arrays: dict[str, np.ndarray] = {}
    with zipfile.ZipFile(path) as archive:
        members = archive.infolist()
        limit = FREE_BYTES + MAX_EXPANSION * path.stat().st_size
        unpacked = sum(info.file_size for info in members)
        if unpacked > limit:
            problem = f"unpacks to {unpacked / 1e6:.0f} MB, expected at most {limit / 1e6:.0f} MB"
            raise ModelFileError(f"{path}: {problem} for a file of its size")
        for info in members:
            name = info.filename.removesuffix(".npy")
            if name in arrays or info.compress_type not in (
                zipfile.ZIP_STORED,
                zipfile.ZIP_DEFLATED,
            ):
                raise ValueError("an array twice, or compressed in another way")
            with archive.open(info) as file:
                version = np.lib.format.read_magic(file)
                if version != (1, 0):
                    raise ValueError("an array in another format")
                shape, _, dtype = np.lib.format.read_array_header_1_0(file)
                size = math.prod(shape) * dtype.itemsize
                if dtype.hasobject or not dtype.itemsize or size != info.file_size - file.tell():
                    raise ValueError("the size of an array differs from its header")
            with archive.open(info) as file:
                arrays[name] = np.lib.format.read_array(file, allow_pickle=False)
    return arrays


def word(arrays: Mapping[str, np.ndarray], name: str) -> str:
    """The text of that name; ValueError if it is none or longer than `MAX_TEXT`."""
    array = arrays[name]
    if array.shape != () or array.dtype.kind != "U":
        raise ValueError(f"{name} is not a text")
    if array.dtype.itemsize > 4 * MAX_TEXT:
        raise ValueError(f"{name} is a text of more than {MAX_TEXT} characters")
    return str(array)


def text(arrays: Mapping[str, np.ndarray], name: str) -> dict:
    """The JSON object in the text array of that name; ValueError if it is none."""
    found = json.loads(word(arrays, name))
    if not isinstance(found, dict):
        raise ValueError(f"{name} is not a JSON object")
    return found


def checked(
    arrays: Mapping[str, np.ndarray],
    name: str,
    shape: tuple[int, ...],
    least: float = -MAX_NUMBER,
    most: float = MAX_NUMBER,
) -> np.ndarray:
    """The array of that name; ValueError unless it has this shape and holds numbers of at most 64
    bits from `least` to `most`."""
    array = arrays[name]
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if array.dtype.kind != "f" or array.dtype.itemsize > 8 or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} holds values that are not finite numbers")
    if array.size and not least <= float(array.min()) <= float(array.max()) <= most:
        raise ValueError(f"{name} holds values that are not from {least:g} to {most:g}")
    return array


def whole(arrays: Mapping[str, np.ndarray], name: str, least: int, most: int) -> int:
    """The whole number of that name; ValueError unless it is from `least` to `most`."""
    array = arrays[name]
    if array.shape != () or array.dtype.kind != "i" or not least <= array <= most:
        raise ValueError(f"{name} is not a whole number from {least} to {most}")
    return int(array)
