"""Training whose loss is no longer a number: where it happened, and what to try."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.models import ConvAutoencoder


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss is no longer a number.

    Parameters
    ----------
    where : str
        Stage, epoch and what was shown, such as "layer 1, epoch 2, window 17".
    culprit : str
        The part of the network that is no longer finite.
    problem : str
        What is wrong and at which rate.
    advice : str
        What may keep it finite.
    """

    def __init__(self, where: str, culprit: str, problem: str, advice: str):
        self.where, self.culprit, self.problem, self.advice = where, culprit, problem, advice
        self.kept = "there is no checkpoint"
        super().__init__(where)

    def __str__(self) -> str:
        return f"{self.where}: {self.problem}, first in {self.culprit}; {self.kept}; {self.advice}"


def first_layer_gone(model: ConvAutoencoder, x: np.ndarray, layer: int | None) -> str:
    """The layer whose numbers are the first to leave the finite ones, on the way that x takes.

    Up through the encoders, tanh holds everything within ±1 as long as the weights are finite; what
    the decoders make has no bound, so that is looked at from the top down.

    Parameters
    ----------
    x : (B, T, C) array
        The input: of the layer in training, or of the network.
    layer : int or None
        Which layer is in training, None for all.
    """
    if layer is not None:
        return f"layer {layer + 1}"
    for number, each in enumerate(model.layers, start=1):
        if not (np.isfinite(each.w).all() and np.isfinite(each.b).all()):
            return f"the weights of layer {number}"
    with np.errstate(all="ignore"):
        hidden = x
        for each in model.layers:
            hidden, _ = each.encode(hidden)
        for number, each in reversed(list(enumerate(model.layers, start=1))):
            hidden, _ = each.decode(hidden)
            if not np.isfinite(hidden).all():
                return f"what layer {number} decodes"
    return "the gradient of the last step"


def gone(weights: Mapping[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold something that is not a finite number."""
    return [name for name, array in weights.items() if not np.isfinite(array).all()]


def shown(chosen: Sequence[int]) -> str:
    """Windows by number, counted from 1, for a message."""
    numbers = ", ".join(str(number + 1) for number in list(chosen)[:8])
    return f"window{'s' * (len(chosen) > 1)} {numbers}{', …' if len(chosen) > 8 else ''}"
