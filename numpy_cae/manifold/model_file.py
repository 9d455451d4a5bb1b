"""Both types of manifold are read from one `.npz` file of plain arrays; nothing is unpickled."""

import json
from collections.abc import Callable
from importlib.resources import as_file, files
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, load_arrays, one_line
from numpy_cae.fast import with_engine
from numpy_cae.manifold import motion_manifold, sequence_manifold
from numpy_cae.manifold.model_arrays import MAX_RATE, read_numbers
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.sequence_manifold import SequenceManifold

Manifold = MotionManifold | SequenceManifold


def load_manifold(path: str | Path, engine: str = "fast") -> Manifold:
    """Read a manifold of either type.

    Parameters
    ----------
    path : path
    engine : {"fast", "ops"}
        What the network computes with: `numpy_cae.fast`, or the definitions in `numpy_cae.ops`.

    Returns
    -------
    MotionManifold or SequenceManifold

    Raises
    ------
    ModelFileError
        If the file is missing or damaged, is not a model of this version, or its arrays do not fit
        together.

    Examples
    --------
    >>> from numpy_cae.manifold import load_manifold
    >>> load_manifold("missing.npz")
    Traceback (most recent call last):
    numpy_cae.array_file.ModelFileError: missing.npz: No such file or directory
    """
    readers: dict[str, Callable[[dict[str, np.ndarray]], Manifold]] = {
        motion_manifold.FORMAT: MotionManifold.from_arrays,
        sequence_manifold.FORMAT: SequenceManifold.from_arrays,
    }
    arrays = load_arrays(path, "a model that `numpy-cae train` wrote", readers)
    try:
        manifold = readers[str(arrays["format"])](arrays)
        manifold.rate = float(read_numbers(arrays, "rate", (), 1.0, MAX_RATE))
        manifold.settings = json.loads(str(arrays["settings"]))
        if not isinstance(manifold.settings, dict):
            raise ValueError("settings is not a JSON object")
    except KeyError as error:
        raise ModelFileError(f"{path}: it has no {error}") from None
    except MemoryError:
        raise
    except Exception as error:  # the arrays may hold anything
        raise ModelFileError(f"{path}: {one_line(error)}") from None
    manifold.network = with_engine(manifold.network, engine)
    return manifold


def starter(engine: str = "fast") -> MotionManifold:
    """The manifold in the package, learned from CMU's database and synthetic motion.

    docs/starter_model.md says how it was learned, its errors and where it fails.

    Parameters
    ----------
    engine : {"fast", "ops"}
        As in `load_manifold`.

    Returns
    -------
    MotionManifold

    Examples
    --------
    >>> from numpy_cae.manifold import starter
    >>> [folder["name"] for folder in starter().settings["folders"]]
    ['asfamc', 'motions']
    """
    with as_file(files("numpy_cae.manifold") / "starter.npz") as path:
        manifold = load_manifold(path, engine)
    assert isinstance(manifold, MotionManifold)
    return manifold
