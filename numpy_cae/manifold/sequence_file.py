"""A manifold of clips as one `.npz` file, beside `model_file`'s form: nothing pickled."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from numpy_cae.array_file import (
    checked,
    form_of,
    load_arrays,
    positive,
    save_arrays,
    text,
)
from numpy_cae.fast import accelerate
from numpy_cae.manifold.sequence_manifold import SequenceManifold
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.motion.angle_table import TABLES

FORMAT = "numpy_cae sequential manifold 1"


def save_sequences(manifold: SequenceManifold, path: str | Path) -> None:
    """Write the manifold, beside first and then moved into place."""
    arrays = {
        "format": np.array(FORMAT),
        "table": np.array(manifold.table.name),
        "columns": np.array(manifold.table.columns),
        "mean": manifold.mean,
        "deviation": manifold.deviation,
        "offsets": manifold.offsets,
        "rate": np.array(manifold.rate),
        "settings": np.array(json.dumps(manifold.settings)),
    }
    save_arrays(arrays | manifold.network.weights, path)


def load_sequences(path: str | Path) -> SequenceManifold:
    """Read what `save_sequences` wrote.

    Raises
    ------
    ModelFileError
        If the file is missing, is none of ours, is a convolutional model, or its arrays do not
        fit together.
    """
    return load_arrays(path, FORMAT, _assembled)


def is_sequential(path: str | Path) -> bool:
    """Whether a model file is one of these."""
    return form_of(path) == FORMAT


def _assembled(arrays: dict[str, np.ndarray]) -> SequenceManifold:
    table = TABLES.get(str(arrays["table"]))
    if table is None or not np.array_equal(arrays["columns"], table.columns):
        raise ValueError("its table of numbers is none of this version")
    if arrays["state_w"].ndim != 2:
        raise ValueError("state_w is no matrix")
    latent, hidden = arrays["state_w"].shape
    numbers = len(table.columns)
    if hidden**2 > sum(array.size for array in arrays.values()):
        raise ValueError("its weights are smaller than state_w says")
    network = accelerate(SequentialAutoencoder(numbers, hidden, latent))
    for name, weight in network.weights.items():
        weight[...] = checked(arrays, name, weight.shape)
    return SequenceManifold(
        network,
        checked(arrays, "mean", (numbers,)),
        positive(arrays, "deviation", (numbers,)),
        table,
        checked(arrays, "offsets", (len(table.joints), 3)),
        text(arrays, "settings"),
        float(positive(arrays, "rate", ())),
    )
