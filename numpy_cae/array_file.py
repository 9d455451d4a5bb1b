"""Files of named arrays (.npz): models and checkpoints are written and read here.

Nothing in such a file is pickled, and the sizes that it declares are compared with the size of the
file before memory is allocated for them.
"""

import io
import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.errors import NumpyCaeError

FREE_BYTES = 1 << 22
MAX_EXPANSION = 8
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


def one_line(error: Exception) -> str:
    return " ".join((str(error) or repr(error)).split())[:500]


def load_arrays(
    path: str | Path, expected: str, formats: Iterable[str] = ()
) -> dict[str, np.ndarray]:
    """Every array of a `.npz` file, if the sum of their sizes fits the size of the file.

    Raises
    ------
    ModelFileError
        If the file is missing, is not what is `expected` or is damaged, unpacks to too many bytes
        or has none of these formats.
    """
    path = Path(path)
    try:
        if path.exists() and not path.is_file():  # a pipe would be waited for
            raise ValueError("it is not a regular file")
        with zipfile.ZipFile(path) as archive:
            unpacked = sum(info.file_size for info in archive.infolist())
        limit = FREE_BYTES + MAX_EXPANSION * path.stat().st_size
        if unpacked > limit:
            problem = f"it unpacks to {unpacked / 1e6:.0f} MB"
            raise ValueError(f"{problem}, expected at most {limit / 1e6:.0f} MB")
        with np.load(path, allow_pickle=False) as file:
            arrays = dict(file)
    except OSError as error:
        raise ModelFileError(f"{path}: {error.strerror or error}") from None
    except MemoryError:  # of this machine, not of the file
        raise
    except Exception as error:  # zipfile, zlib and NumPy raise a dozen types for damaged bytes
        raise ModelFileError(f"{path}: not {expected}: {one_line(error)}") from None
    stated = str(arrays.get("format"))
    if formats and stated not in formats:
        problem = f"its format is {stated[:80]!r}, expected {' or '.join(map(repr, formats))}"
        raise ModelFileError(f"{path}: {problem}; make the file again with this version")
    return arrays
