"""Layer by layer, then all together: the training of holden2015, section 6.

Each layer learns to reproduce what the trained layers below it make of the clean motion, from a
corrupted copy of that (Vincent 2010). Fine tuning then trains the whole stack at once, from
corrupted motion to clean motion.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.models import ConvAutoencoder
from numpy_cae.training.corruption import corrupt
from numpy_cae.training.progress import Progress
from numpy_cae.training.schedule import Schedule, Stage
from numpy_cae.training.sgd import decayed_rate, descend


class DivergedError(ArithmeticError):
    """Training whose loss is no longer a number."""


@dataclass
class History:
    """What happened in each stage: "layer 1", …, "fine tuning".

    Attributes
    ----------
    losses : stage to the mean loss of every epoch
    seconds : stage to the time that its epochs took
    """

    losses: dict[str, list[float]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)


def train_autoencoder(
    model: ConvAutoencoder,
    windows: np.ndarray,
    schedule: Schedule | None = None,
    rng: np.random.Generator | None = None,
    show_progress: bool = True,
) -> History:
    """Train the model in place.

    Parameters
    ----------
    model : ConvAutoencoder
    windows : (N, T, C) array in the dtype of the model
        Normalised windows; T is a multiple of `model.frames_per_unit`.
    schedule : Schedule, optional
        The paper's where none is given.
    rng : numpy.random.Generator, optional
        Draws the order of the windows, the corruption and the unpooling. Two runs from the same
        seed on the same number of threads are equal to the bit.
    show_progress : bool

    Returns
    -------
    History

    Raises
    ------
    DivergedError
        If a loss is not finite, with the stage and the epoch.
    """
    schedule = schedule or Schedule()
    rng = rng or np.random.default_rng(0)
    history = History()
    model.thaw()
    inputs = windows
    for index, layer in enumerate(model.layers):
        name = f"layer {index + 1}"
        start = time.perf_counter()
        history.losses[name] = _train_stage(
            model, inputs, schedule.layer, rng, name, show_progress, index
        )
        history.seconds[name] = time.perf_counter() - start
        inputs = _encoded(layer, inputs) if index + 1 < len(model.layers) else None
    start = time.perf_counter()
    history.losses["fine tuning"] = _train_stage(
        model, windows, schedule.fine_tuning, rng, "fine tuning", show_progress
    )
    history.seconds["fine tuning"] = time.perf_counter() - start
    return history


def _train_stage(
    model: ConvAutoencoder,
    inputs: np.ndarray,
    stage: Stage,
    rng: np.random.Generator,
    name: str,
    show_progress: bool,
    layer: int | None = None,
) -> list[float]:
    steps = -(-len(inputs) // stage.batch)
    progress = Progress(name, stage.epochs, steps, show_progress)
    losses = []
    try:
        for epoch in range(stage.epochs):
            rate = decayed_rate(stage.rate, stage.decay, epoch)
            total = 0.0
            for chosen in _batches(len(inputs), stage.batch, rng):
                loss = _step(model, inputs[chosen], stage, rate, rng, layer)
                if not np.isfinite(loss):
                    raise DivergedError(
                        f"{name}, epoch {epoch + 1}: the loss is {loss} at rate {rate:.4g}; "
                        "a lower rate or smaller values of the input may keep it finite"
                    )
                total += loss * len(chosen)
                progress.step()
            losses.append(total / len(inputs))
            progress.epoch(epoch, losses[-1])
    finally:
        progress.close()
    return losses


def _batches(windows: int, batch: int, rng: np.random.Generator) -> list[np.ndarray]:
    """The windows in a new order, `batch` at a time."""
    order = rng.permutation(windows)
    return [order[start : start + batch] for start in range(0, windows, batch)]


def _step(
    model: ConvAutoencoder,
    x: np.ndarray,
    stage: Stage,
    rate: float,
    rng: np.random.Generator,
    layer: int | None,
) -> float:
    """Corrupt, compare, descend: one step on one batch, for one layer or (None) for all."""
    corrupted = corrupt(x, stage.zeroed, stage.rescaled, rng)
    trained = model.layers if layer is None else [model.layers[layer]]
    first = None if layer is None else [_drawn_mask(x, trained[0].b.size, rng)]
    loss, gradients = model.loss_and_gradients(x, corrupted, stage.alpha, first, layer)
    for each, (dw, db) in zip(trained, gradients, strict=True):
        descend((each.w, each.b), (dw, db), rate)
    return loss


def _drawn_mask(x: np.ndarray, filters: int, rng: np.random.Generator) -> np.ndarray:
    """Where each unpooled value goes: to the first frame of its pair in half of all cases."""
    batch, frames, _ = x.shape
    return rng.random((batch, frames // 2, filters), dtype=np.float32) < 0.5


def _encoded(layer, inputs: np.ndarray, at_once: int = 64) -> np.ndarray:
    """What the layer makes of clean input, a part at a time to spare memory."""
    windows, frames, _ = inputs.shape
    encoded = np.empty((windows, frames // 2, layer.b.size), dtype=inputs.dtype)
    for start in range(0, windows, at_once):
        part = slice(start, start + at_once)
        encoded[part], _ = layer.encode(inputs[part])
    return encoded
