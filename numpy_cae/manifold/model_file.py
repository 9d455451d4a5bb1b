"""Both kinds of manifold as one `.npz` file: plain arrays and settings in JSON, nothing pickled."""

import json
from collections.abc import Callable
from importlib.resources import as_file, files
from itertools import pairwise
from pathlib import Path

import numpy as np

from numpy_cae.array_file import checked, load_arrays, save_arrays, text, whole, word
from numpy_cae.manifold.motion_manifold import MotionManifold, with_engine
from numpy_cae.manifold.sequence_manifold import SequenceManifold
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.motion.angle_table import TABLES
from numpy_cae.motion.features import FEATURES
from numpy_cae.motion.joints import JOINTS

Manifold = MotionManifold | SequenceManifold
CONVOLUTIONAL = "numpy_cae convolutional manifold 3"
SEQUENTIAL = "numpy_cae sequential manifold 4"
CONVOLUTIONAL_2, SEQUENTIAL_2 = CONVOLUTIONAL[:-1] + "2", SEQUENTIAL[:-1] + "2"
SEQUENTIAL_3 = SEQUENTIAL[:-1] + "3"
"""Formats of earlier versions: the first two without a digest, sequential ones without burn_in."""
SMALLEST, MAX_LENGTH, MAX_RATE = 1e-6, 10.0, 1000.0
"""Least factor and deviation; longest bone in metres; most frames a second."""
MAX_FRAMES = 100_000
"""Longest window or clip that a file may state."""


def save_manifold(manifold: Manifold, path: str | Path, half: bool = False) -> None:
    """Write a manifold of either kind, atomically; with `half`, weights in float16."""
    if isinstance(manifold, SequenceManifold):
        arrays = _arrays_of_sequences(manifold)
    else:
        arrays = _arrays_of_motions(manifold)
        if half:
            weights = [name for name in arrays if name[1:].isdigit()]
            arrays |= {name: arrays[name].astype(np.float16) for name in weights}
    save_arrays(arrays | {"settings": np.array(json.dumps(manifold.settings))}, path)


def load_manifold(path: str | Path, engine: str = "fast") -> Manifold:
    """Read a manifold of either kind; its network computes by `engine`, "fast" or "ops".

    Raises
    ------
    ModelFileError
        If the file is missing, is not a model of this version, was changed after it was written, or
        its arrays do not fit together.
    """
    readers: dict[str, Callable[[dict[str, np.ndarray]], Manifold]] = {
        **dict.fromkeys((CONVOLUTIONAL, CONVOLUTIONAL_2), _motions_of),
        **dict.fromkeys((SEQUENTIAL, SEQUENTIAL_3, SEQUENTIAL_2), _sequences_of),
    }
    manifold = load_arrays(path, readers, (CONVOLUTIONAL_2, SEQUENTIAL_2))
    manifold.network = with_engine(manifold.network, engine)
    return manifold


def starter(engine: str = "fast") -> MotionManifold:
    """The manifold in the package, learned from CMU's database and synthetic motion.

    docs/starter_model.md says how, what it measures and where it fails; `engine` is as in
    `load_manifold`.
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
    for number, layer in enumerate(layers, start=1):
        arrays[f"w{number}"], arrays[f"b{number}"] = layer.w, layer.b
    return arrays


def _motions_of(arrays: dict[str, np.ndarray]) -> MotionManifold:
    if not np.array_equal(arrays["joints"], JOINTS):
        raise ValueError("its twenty joints are not those of this version")
    count = max(1, sum(f"w{number}" in arrays for number in range(1, len(arrays))))
    taps = len(arrays["w1"])
    filters = [arrays[f"b{number}"].size for number in range(1, count + 1)]
    # Before a network of these sizes is made:
    for number, (below, above) in enumerate(pairwise((FEATURES, *filters)), start=1):
        for name, shape in ((f"w{number}", (taps, below, above)), (f"b{number}", (above,))):
            if checked(arrays, name, shape).dtype != arrays["w1"].dtype:
                raise ValueError(f"{name} has another dtype than w1")
    bound = checked(arrays, "bound", (), SMALLEST, 1 - SMALLEST)
    network = ConvAutoencoder(FEATURES, filters, taps, float(bound))
    for number, layer in enumerate(network.layers, start=1):
        # float16 in the package's starter model, to save space
        layer.w, layer.b = (
            np.asarray(arrays[name], np.promote_types(arrays[name].dtype, np.float32))
            for name in (f"w{number}", f"b{number}")
        )
    return MotionManifold(
        network,
        checked(arrays, "mean_pose", (FEATURES,)),
        checked(arrays, "scale", (FEATURES,), SMALLEST),
        checked(arrays, "lengths", (len(JOINTS),), 0.0, MAX_LENGTH),
        float(checked(arrays, "rate", (), 1.0, MAX_RATE)),
        text(arrays, "settings"),
        bool(whole(arrays, "rescales", 0, 1)),
        whole(arrays, "window", 1, MAX_FRAMES),
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
    table = TABLES.get(word(arrays, "table"))
    if table is None or not np.array_equal(arrays["columns"], table.columns):
        raise ValueError("its table of columns is not one of this version")
    if arrays["state_w"].ndim != 2:
        raise ValueError("state_w is not a matrix")
    latent, hidden = arrays["state_w"].shape
    numbers = len(table.columns)
    if hidden**2 > sum(array.size for array in arrays.values()):
        raise ValueError("its weights are smaller than state_w says")
    network = SequentialAutoencoder(numbers, hidden, latent)
    if word(arrays, "format") == SEQUENTIAL:
        network.burn_in = whole(arrays, "burn_in", 0, MAX_FRAMES)
    for name, weight in network.weights.items():
        weight[...] = checked(arrays, name, weight.shape)
    return SequenceManifold(
        network,
        checked(arrays, "mean", (numbers,)),
        checked(arrays, "deviation", (numbers,), SMALLEST),
        table,
        checked(arrays, "offsets", (len(table.joints), 3), -MAX_LENGTH, MAX_LENGTH),
        text(arrays, "settings"),
        float(checked(arrays, "rate", (), 1.0, MAX_RATE)),
        whole(arrays, "frames", 1, MAX_FRAMES),
    )
