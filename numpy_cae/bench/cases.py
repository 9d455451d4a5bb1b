"""What is timed: a step of every stage of training, encoding, and encoding with decoding."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from numpy_cae.bench import arithmetic
from numpy_cae.models import ConvAutoencoder

FRAMES = 160


@dataclass(frozen=True)
class Case:
    """One thing to time.

    Parameters
    ----------
    name : str
        Such as "layer 2, random".
    kind : "step", "encode" or "project"
    x, corrupted : (B, T, C) arrays
    first : list of masks, or None for even unpooling
    layer : int or None
        The layer that is trained by itself.
    operations : int
        Of the direct form, for the whole batch.
    """

    name: str
    kind: str
    x: np.ndarray
    corrupted: np.ndarray
    first: list[np.ndarray] | None
    layer: int | None
    operations: int

    def ours(self, model: ConvAutoencoder) -> Callable[[], object]:
        """The case as a function without arguments."""
        return {
            "step": lambda: model.loss_and_gradients(
                self.x, self.corrupted, alpha(self), self.first, self.layer
            ),
            "encode": lambda: model.encode(self.x),
            "project": lambda: model.project(self.x),
        }[self.kind]


def alpha(case: Case) -> float:
    """The sparsity that the paper trains with in this stage."""
    return 0.0 if case.layer is None else 0.01


def cases(model: ConvAutoencoder, batch: int, seed: int = 0) -> Iterator[Case]:
    """Every case for one size of batch: random numbers of the size that training sees."""
    rng = np.random.default_rng(seed)
    layers, dtype = model.layers, model.layers[0].w.dtype
    for index in (*range(len(layers)), None):
        used = layers if index is None else [layers[index]]
        frames = FRAMES >> (index or 0)
        x = (0.25 * rng.normal(size=(batch, frames, used[0].w.shape[1]))).astype(dtype)
        corrupted = x * (rng.random(x.shape) >= 0.1)
        masks = [
            rng.random((batch, frames >> (k + 1), layer.b.size)) < 0.5
            for k, layer in enumerate(used)
        ]
        operations = batch * arithmetic.training_step(used, frames)
        name = "whole" if index is None else f"layer {index + 1}"
        for unpooling, first in (("random", masks), ("even", None)):
            yield Case(f"{name}, {unpooling}", "step", x, corrupted, first, index, operations)
    operations = batch * arithmetic.encoding(layers, FRAMES)
    yield Case("encode", "encode", x, x, None, None, operations)
    yield Case("encode + decode", "project", x, x, None, None, 2 * operations)
