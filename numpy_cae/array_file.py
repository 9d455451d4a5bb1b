"""Files of named arrays (.npz): models and checkpoints are written, read and checked here.

Nothing in such a file is pickled, and the sizes that it declares are compared with the size of the
file before memory is allocated for them.
"""

import io
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.errors import NumpyCaeError

Model = TypeVar("Model")

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


def load_arrays(
    path: str | Path, readers: Mapping[str, Callable[[dict[str, np.ndarray]], Model]]
) -> Model:
    """Read what `save_arrays` wrote and make a model of it.

    Parameters
    ----------
    path : path
    readers : mapping of format to function (dict of arrays) -> model
        For each accepted value of the array `format`. Any exception that the function raises
        becomes a `ModelFileError`.

    Raises
    ------
    ModelFileError
        If the file is missing or damaged, unpacks to too many bytes, has another format, or its
        arrays do not fit together.
    """
    arrays = read_arrays(path, "a model that `numpy-cae train` wrote")
    stated = str(arrays.get("format"))
    if stated not in readers:
        expected = " or ".join(map(repr, readers))
        problem = f"its format is {stated[:80]!r}, expected {expected}"
        raise ModelFileError(f"{path}: {problem}; make the file again with this version")
    try:
        return readers[stated](arrays)
    except KeyError as error:
        raise ModelFileError(f"{path}: it has no {error}") from None
    except Exception as error:  # the arrays may hold anything
        raise ModelFileError(f"{path}: {_one_line(error)}") from None


def _one_line(error: Exception) -> str:
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
        raise ModelFileError(f"{path}: not {expected}: {_one_line(error)}") from None


def _read_arrays(path: Path) -> dict[str, np.ndarray]:
    if path.exists() and not path.is_file():  # a pipe would be waited for
        raise ValueError("it is not a regular file")
    with zipfile.ZipFile(path) as archive:
        unpacked = sum(info.file_size for info in archive.infolist())
    limit = FREE_BYTES + MAX_EXPANSION * path.stat().st_size
    if unpacked > limit:
        raise ValueError(
            f"it unpacks to {unpacked / 1e6:.0f} MB, expected at most {limit / 1e6:.0f} MB"
        )
    with np.load(path, allow_pickle=False) as file:
        return dict(file)
