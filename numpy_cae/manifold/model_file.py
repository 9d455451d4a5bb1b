"""Both types of manifold as one `.npz` file: plain arrays and settings in JSON, nothing pickled."""

import json
from collections.abc import Callable, Mapping
from importlib.resources import as_file, files
from itertools import pairwise
from pathlib import Path

import numpy as np

from numpy_cae.array_file import load_arrays, save_arrays
from numpy_cae.manifold.motion_manifold import MotionManifold, with_engine
from numpy_cae.manifold.sequence_manifold import SequenceManifold
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.models.linear_denoiser import TAPS, LinearDenoiser
from numpy_cae.motion.angle_table import TABLES
from numpy_cae.motion.features import FEATURES
from numpy_cae.motion.joints import JOINTS

Manifold = MotionManifold | SequenceManifold
CONVOLUTIONAL = "numpy_cae convolutional manifold 3"
SEQUENTIAL = "numpy_cae sequential manifold 4"
"""The only formats that are read: a file of another version has to be made again."""
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


def save_manifold(manifold: Manifold, path: str | Path, half: bool = False) -> None:
    """Write a manifold of either type, completely or not at all.

    Parameters
    ----------
    manifold : MotionManifold or SequenceManifold
    path : path
        The file to write, .npz.
    half : bool
        Whether to write the weights of a convolutional network as float16.

    Raises
    ------
    FileError
        If the file cannot be written.

    Examples
    --------
    >>> from numpy_cae.manifold import load_manifold, save_manifold, starter
    >>> save_manifold(starter(), "model.npz", half=True)
    >>> load_manifold("model.npz").stride
    8
    """
    if isinstance(manifold, SequenceManifold):
        arrays = _arrays_of_sequences(manifold)
    else:
        arrays = _arrays_of_motions(manifold)
        if half:
            weights = [name for name in arrays if name[1:].isdigit()]
            arrays |= {name: arrays[name].astype(np.float16) for name in weights}
    save_arrays(arrays | {"settings": np.array(json.dumps(manifold.settings))}, path)


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
        CONVOLUTIONAL: _motions_of,
        SEQUENTIAL: _sequences_of,
    }
    manifold = load_arrays(path, readers)
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


def _arrays_of_motions(manifold: MotionManifold) -> dict[str, np.ndarray]:
    layers = manifold.network.layers
    arrays = {
        "format": np.array(CONVOLUTIONAL),
        "mean_pose": manifold.mean_pose,
        "scale": manifold.scale,
        "rate": np.array(manifold.rate),
        "joints": np.array(JOINTS),
        "lengths": manifold.lengths,
        "bound": np.array(layers[0].bound),
        "rescales": np.array(int(manifold.rescales)),
        "window": np.array(manifold.window),
    }
    if manifold.linear is not None:
        arrays["linear"] = manifold.linear.weights
    for number, layer in enumerate(layers, start=1):
        arrays[f"w{number}"], arrays[f"b{number}"] = layer.w, layer.b
    return arrays


def _motions_of(arrays: dict[str, np.ndarray]) -> MotionManifold:
    if not np.array_equal(arrays["joints"], JOINTS):
        raise ValueError("its twenty joints are not those of this version")
    # Filters w and biases b of each layer; where one array is missing, this raises KeyError.
    count = -(-sum(name[0] in "wb" and name[1:].isdigit() for name in arrays) // 2)
    taps, filters = len(arrays["w1"]), [arrays[f"b{n}"].size for n in range(1, count + 1)]
    # Before a network of these sizes is made:
    for number, (below, above) in enumerate(pairwise((FEATURES, *filters)), start=1):
        numbers(arrays, f"w{number}", (taps, below, above))
        numbers(arrays, f"b{number}", (above,))
    bound = numbers(arrays, "bound", (), SMALLEST, 1 - SMALLEST)
    network = ConvAutoencoder(FEATURES, filters, taps, float(bound))
    # The weights of the starter model are float16, to save space.
    dtype = np.promote_types(arrays["w1"].dtype, np.float32)
    for number, layer in enumerate(network.layers, start=1):
        layer.w, layer.b = (arrays[f"{name}{number}"].astype(dtype) for name in "wb")
    linear = None
    if "linear" in arrays:  # a model that was made without rescaling has none
        linear = LinearDenoiser(numbers(arrays, "linear", (TAPS, FEATURES, FEATURES)))
    return MotionManifold(
        network,
        numbers(arrays, "mean_pose", (FEATURES,)),
        numbers(arrays, "scale", (FEATURES,), SMALLEST),
        numbers(arrays, "lengths", (len(JOINTS),), 0.0, MAX_LENGTH),
        float(numbers(arrays, "rate", (), 1.0, MAX_RATE)),
        json_object(arrays, "settings"),
        bool(integer(arrays, "rescales", 0, 1)),
        integer(arrays, "window", 1, MAX_FRAMES),
        linear,
    )


def _arrays_of_sequences(manifold: SequenceManifold) -> dict[str, np.ndarray]:
    return {
        "format": np.array(SEQUENTIAL),
        "table": np.array(manifold.table.name),
        "columns": np.array(manifold.table.columns),
        "mean": manifold.mean,
        "deviation": manifold.deviation,
        "offsets": manifold.offsets,
        "rate": np.array(manifold.rate),
        "frames": np.array(manifold.frames),
        "burn_in": np.array(manifold.network.burn_in),
        **manifold.network.weights,
    }


def _sequences_of(arrays: dict[str, np.ndarray]) -> SequenceManifold:
    table = TABLES.get(str(arrays["table"]))
    if table is None or not np.array_equal(arrays["columns"], table.columns):
        raise ValueError("its table of columns is not one of this version")
    latent, hidden = arrays["state_w"].shape
    columns = len(table.columns)
    if hidden**2 > sum(array.size for array in arrays.values()):
        raise ValueError("its weights are fewer than the width of state_w requires")
    network = SequentialAutoencoder(columns, hidden, latent)
    network.burn_in = integer(arrays, "burn_in", 0, MAX_FRAMES)
    for name, weight in network.weights.items():
        weight[...] = numbers(arrays, name, weight.shape)
    return SequenceManifold(
        network,
        numbers(arrays, "mean", (columns,)),
        numbers(arrays, "deviation", (columns,), SMALLEST),
        table,
        numbers(arrays, "offsets", (len(table.joints), 3), -MAX_LENGTH, MAX_LENGTH),
        json_object(arrays, "settings"),
        float(numbers(arrays, "rate", (), 1.0, MAX_RATE)),
        integer(arrays, "frames", 1, MAX_FRAMES),
    )


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
