"""A manifold as one `.npz` file: plain arrays and one text of JSON, nothing pickled."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.features import FEATURES
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.whole_file import whole_file

FORMAT = "numpy_cae convolutional manifold 1"


class ModelFileError(ValueError):
    """A model file that cannot be used as it stands."""


def save_manifold(manifold: MotionManifold, path: str | Path) -> None:
    """Write the manifold, beside first and then moved into place."""
    network = manifold.network
    arrays = {
        "format": np.array(FORMAT),
        "mean_pose": manifold.mean_pose,
        "scale": manifold.scale,
        "rate": np.array(manifold.rate),
        "joints": np.array(JOINTS),
        "parents": np.array(PARENTS),
        "lengths": manifold.lengths,
        "bound": np.array(network.layers[0].bound),
        "settings": np.array(json.dumps(manifold.settings)),
    }
    for index, layer in enumerate(network.layers):
        arrays[f"w{index + 1}"], arrays[f"b{index + 1}"] = layer.w, layer.b
    with whole_file(path) as beside, open(beside, "wb") as file:
        np.savez_compressed(file, **arrays)


def load_manifold(path: str | Path) -> MotionManifold:
    """Read what `save_manifold` wrote.

    Raises
    ------
    ModelFileError
        If the file is missing, is none of ours, or its arrays do not fit together.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except OSError as error:
        raise ModelFileError(f"{path}: {error.strerror or error}") from None
    except (ValueError, EOFError, zipfile.BadZipFile, AttributeError, zipfile.zlib.error):
        raise ModelFileError(f"{path}: not a model that `numpy-cae train` wrote") from None
    try:
        return _assembled(arrays)
    except (KeyError, ValueError, TypeError) as error:
        raise ModelFileError(f"{path}: {error}") from None


def _assembled(arrays: dict[str, np.ndarray]) -> MotionManifold:
    if str(arrays.get("format", "")) != FORMAT:
        raise ValueError(f"not a {FORMAT!r}, but {str(arrays.get('format', 'no model'))!r}")
    if tuple(arrays["joints"]) != JOINTS:
        raise ValueError("its twenty joints are not the ones of this version")
    count = sum(name[0] == "w" and name[1:].isdigit() for name in arrays)
    filters = [len(arrays[f"b{index + 1}"]) for index in range(count)]
    network = ConvAutoencoder(FEATURES, filters, len(arrays["w1"]), float(arrays["bound"]))
    for index, layer in enumerate(network.layers):
        layer.w = _checked(arrays, f"w{index + 1}", layer.w.shape)
        layer.b = _checked(arrays, f"b{index + 1}", layer.b.shape)
    return MotionManifold(
        network.freeze(),
        _checked(arrays, "mean_pose", (FEATURES,)),
        _checked(arrays, "scale", (FEATURES,)),
        _checked(arrays, "lengths", (len(JOINTS),)),
        float(_checked(arrays, "rate", ())),
        json.loads(str(arrays["settings"])),
    )


def _checked(arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    array = arrays[name]
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if array.dtype.kind != "f" or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} holds values that are not finite numbers")
    return array
