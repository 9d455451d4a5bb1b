"""Files of named arrays (.npz): models and checkpoints are written, read and checked here.

Nothing in such a file is pickled, and the sizes that it declares are compared with the size of the
file before memory is allocated for them.
A model's arrays, plain numbers and settings in JSON, are checked before they are used.
"""

import io
import json
import zipfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.errors import NumpyCaeError

FREE_BYTES, MAX_EXPANSION = 1 << 22, 8
"""A file may unpack to at most FREE_BYTES + MAX_EXPANSION · its size; weights hardly compress."""


class ModelFileError(NumpyCaeError, ValueError):
    """A model file that cannot be used."""


def save_arrays(arrays: dict[str, np.ndarray], path: str | Path, compressed: bool = True) -> None:
    """Write named arrays as `.npz`, completely or not at all.

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


def load_arrays(path: str | Path, formats: Iterable[str]) -> dict[str, np.ndarray]:
    """Read what `save_arrays` wrote, in one of these formats.

    Raises
    ------
    ModelFileError
        If the file is missing or damaged, unpacks to too many bytes or has another format.
    """
    arrays = read_arrays(path, "a model that `numpy-cae train` wrote")
    stated = str(arrays.get("format"))
    if stated not in formats:
        expected = " or ".join(map(repr, formats))
        problem = f"its format is {stated[:80]!r}, expected {expected}"
        raise ModelFileError(f"{path}: {problem}; make the file again with this version")
    return arrays


def one_line(error: Exception) -> str:
    return " ".join((str(error) or repr(error)).split())[:500]


def read_arrays(path: str | Path, expected: str) -> dict[str, np.ndarray]:
    """Every array of a `.npz` file, if the sum of their sizes fits the size of the file.

    Raises ModelFileError, which says that the file is not what is `expected`.
    """
    try:
        return _read_arrays(Path(path))
    except OSError as error:
        raise ModelFileError(f"{path}: {error.strerror or error}") from None
    except Exception as error:  # zipfile, zlib and NumPy raise a dozen types for damaged bytes
        raise ModelFileError(f"{path}: not {expected}: {one_line(error)}") from None


def _read_arrays(path: Path) -> dict[str, np.ndarray]:
    if path.exists() and not path.is_file():  # a pipe would be waited for
        raise ValueError("it is not a regular file")
    with zipfile.ZipFile(path) as archive:
        unpacked = sum(info.file_size for info in archive.infolist())
    limit = FREE_BYTES + MAX_EXPANSION * path.stat().st_size
    if unpacked > limit:
        problem = f"it unpacks to {unpacked / 1e6:.0f} MB"
        raise ValueError(f"{problem}, expected at most {limit / 1e6:.0f} MB")
    with np.load(path, allow_pickle=False) as file:
        return dict(file)


SMALLEST = 1e-6
"""Smallest factor and smallest deviation by which features may be divided."""
MAX_NUMBER = 1e6
"""Largest absolute value of a number in a model file, unless a reader states a smaller one."""
MAX_LENGTH = 10.0
"""Longest bone (m)."""
MAX_RATE = 1000.0
"""Most frames a second."""
MAX_FRAMES = 100_000
"""Longest window or clip that a file may state."""


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
