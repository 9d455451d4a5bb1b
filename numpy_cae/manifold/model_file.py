"""A manifold as one `.npz` file: plain arrays and one text of JSON, nothing pickled."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np

from numpy_cae.array_file import (
    checked,
    load_arrays,
    positive,
    save_arrays,
    text,
)
from numpy_cae.fast import accelerate
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.features import FEATURES
from numpy_cae.motion.joints import JOINTS, PARENTS

FORMAT = "numpy_cae convolutional manifold 1"


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
    save_arrays(arrays, path)


def load_manifold(path: str | Path) -> MotionManifold:
    """Read what `save_manifold` wrote.

    Raises
    ------
    ModelFileError
        If the file is missing, is none of ours, or its arrays do not fit together.
    """
    return load_arrays(path, FORMAT, _assembled)


def _assembled(arrays: dict[str, np.ndarray]) -> MotionManifold:
    if not np.array_equal(arrays["joints"], JOINTS):
        raise ValueError("its twenty joints are not the ones of this version")
    count = max(1, sum(f"w{index + 1}" in arrays for index in range(len(arrays))))
    taps, filters = len(arrays["w1"]), [arrays[f"b{index + 1}"].size for index in range(count)]
    # Before the network is made: it is as large as these say.
    for index, (below, above) in enumerate(pairwise((FEATURES, *filters))):
        checked(arrays, f"w{index + 1}", (taps, below, above))
        checked(arrays, f"b{index + 1}", (above,))
    network = ConvAutoencoder(FEATURES, filters, taps, float(checked(arrays, "bound", ())))
    for index, layer in enumerate(network.layers):
        layer.w, layer.b = arrays[f"w{index + 1}"], arrays[f"b{index + 1}"]
    return MotionManifold(
        accelerate(network),
        checked(arrays, "mean_pose", (FEATURES,)),
        positive(arrays, "scale", (FEATURES,)),
        checked(arrays, "lengths", (len(JOINTS),)),
        float(positive(arrays, "rate", ())),
        text(arrays, "settings"),
    )
