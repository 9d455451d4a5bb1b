"""One step of training of each network: holden2015, section 6, and jang2018."""

from __future__ import annotations

from typing import Any

import numpy as np

from numpy_cae.training.adam import Adam
from numpy_cae.training.corruption import corrupt
from numpy_cae.training.schedule import EVEN, SequenceSchedule, Stage
from numpy_cae.training.sgd import Sgd, clip_norm


def denoising_step(
    model: Any,
    x: np.ndarray,
    stage: Stage,
    rate: float,
    rng: np.random.Generator,
    optimiser: Sgd | Adam,
    layer: int | None = None,
) -> float:
    """Corrupt, compare, descend: one step of holden2015 on one batch.

    x : (B, T, C) are clean windows, or what the trained layers below `layer` make of them; `layer`
    is the one layer to train, 0 the lowest, or None for all. Returns the loss of equation 3 before
    the step; if it is not finite, no weight is changed.
    """
    corrupted = corrupt(x, stage.zeroed, stage.rescaled, rng)
    first = _unpooling_masks(model, x, stage, layer, rng)
    loss, gradients = model.loss_and_gradients(x, corrupted, stage.alpha, first, layer)
    if np.isfinite(loss):
        optimiser.update([each for of_layer in gradients for each in of_layer], rate)
    return loss


def sequence_step(
    model: Any,
    x: np.ndarray,
    schedule: SequenceSchedule,
    rate: float,
    rng: np.random.Generator,
    optimiser: Sgd | Adam,
) -> tuple[Any, float]:
    """Draw, compare, clip, descend: one step of jang2018 on one batch.

    x : (B, T, features) are normalised clips. Returns the losses before the step and the norm of
    the gradient before it was clipped; if the total is not finite, no weight is changed.
    """
    if schedule.posture:
        shape = (len(x), 1, x.shape[2])
        x = x + schedule.posture * rng.standard_normal(shape, dtype=x.dtype)
    prior = rng.standard_normal((len(x), model.latent)).astype(x.dtype)
    directions = unit_directions(schedule.directions, model.latent, rng, x.dtype)
    losses, gradients = model.loss_and_gradients(x, prior, directions, schedule.weight)
    if not np.isfinite(losses.total):
        return losses, float("nan")
    norm = clip_norm(list(gradients.values()), schedule.norm)
    optimiser.update(gradients.values(), rate)
    return losses, norm


def unit_directions(
    count: int, dimensions: int, rng: np.random.Generator, dtype: np.dtype | type = np.float32
) -> np.ndarray:
    """Rows of length 1 in uniformly distributed directions: (count, dimensions)."""
    drawn = rng.standard_normal((count, dimensions))
    return (drawn / np.linalg.norm(drawn, axis=1, keepdims=True)).astype(dtype)


def make_optimiser(
    stage: Stage | SequenceSchedule, parameters: dict[str, np.ndarray]
) -> Sgd | Adam:
    """The optimiser that the stage names, at rest, over these parameters."""
    return Adam(parameters) if stage.optimiser == "adam" else Sgd(parameters, stage.momentum)


def _unpooling_masks(
    model: Any, x: np.ndarray, stage: Stage, layer: int | None, rng: np.random.Generator
) -> list[np.ndarray] | None:
    """A mask for each layer in training, lowest first; None for unpooling evenly."""
    if stage.unpooling == EVEN or (stage.unpooling is None and layer is None):
        return None
    layers = model.layers if layer is None else [model.layers[layer]]
    return [_unpooling_mask(x[:, :: 2**k], each.b.size, rng) for k, each in enumerate(layers)]


def _unpooling_mask(x: np.ndarray, filters: int, rng: np.random.Generator) -> np.ndarray:
    """True, with probability one half, where the value goes to the first frame of its pair."""
    batch, frames, _ = x.shape
    return rng.random((batch, frames // 2, filters), dtype=np.float32) < 0.5
