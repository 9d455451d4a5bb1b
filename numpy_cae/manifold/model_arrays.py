"""Model files as plain arrays: what every kind of them is read and checked by."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

from numpy_cae.motion.whole_file import whole_file

Model = TypeVar("Model")


class ModelFileError(ValueError):
    """A model file that cannot be used as it stands."""


def save_arrays(arrays: dict[str, np.ndarray], path: str | Path) -> None:
    """Write the arrays as `.npz`, beside first and then moved into place."""
    with whole_file(path) as beside, open(beside, "wb") as file:
        np.savez_compressed(file, **arrays)


def load_arrays(
    path: str | Path, form: str, assembled: Callable[[dict[str, np.ndarray]], Model]
) -> Model:
    """Read what `save_arrays` wrote and make a model of it.

    Parameters
    ----------
    path : path
    form : str
        What the array `format` must say.
    assembled : dict of arrays -> model
        A KeyError, ValueError or TypeError that it raises becomes a `ModelFileError`.

    Raises
    ------
    ModelFileError
        If the file is missing, is none of ours or of another kind, or its arrays do not fit
        together.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except OSError as error:
        raise ModelFileError(f"{path}: {error.strerror or error}") from None
    except (ValueError, EOFError, zipfile.BadZipFile, AttributeError, zipfile.zlib.error):
        raise ModelFileError(f"{path}: not a model that `numpy-cae train` wrote") from None
    found = str(arrays.get("format", "no model"))
    if found != form:
        raise ModelFileError(f"{path}: not a {form!r}, but {found!r}")
    try:
        return assembled(arrays)
    except (KeyError, ValueError, TypeError) as error:
        raise ModelFileError(f"{path}: {error}") from None


def checked(arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """The array of that name if it has the shape and holds finite numbers; else ValueError."""
    array = arrays[name]
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if array.dtype.kind != "f" or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} holds values that are not finite numbers")
    return array
