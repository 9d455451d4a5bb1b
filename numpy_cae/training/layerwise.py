"""Layer by layer, then all together: the training of holden2015, section 6.

Each layer learns to reproduce what the trained layers below it make of the clean motion, from a
corrupted copy of that (Vincent 2010). Fine tuning then trains the whole stack at once, from
corrupted motion to clean motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from numpy_cae.models import ConvLayer
from numpy_cae.training.checkpoint import Checkpoint, fingerprint
from numpy_cae.training.divergence import DivergenceCheck, nonfinite
from numpy_cae.training.loop import Callback, Loop, Task
from numpy_cae.training.progress import Progress
from numpy_cae.training.schedule import Schedule, Stage
from numpy_cae.training.step import denoising_step, make_optimiser

ADVICE = "a lower rate or smaller values of the input (--rate, --rms) may keep it finite"


@dataclass
class History(Callback):
    """The mean loss of each epoch, and the seconds, by stage: "layer 1", …, "fine tuning"."""

    losses: dict[str, list[float]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Add the epoch."""
        self.losses[loop.task.name].append(loss)
        self.seconds[loop.task.name] = loop.at.seconds


def train_autoencoder(
    model: Any,
    windows: np.ndarray,
    schedule: Schedule | None = None,
    rng: np.random.Generator | None = None,
    show_progress: bool = True,
    checkpoint: Checkpoint | None = None,
) -> History:
    """Train the model in place.

    Parameters
    ----------
    model : ConvAutoencoder, or what `fast.accelerate` makes of it
    windows : (N, T, C) array in the dtype of the model
        Normalised windows; T is a multiple of `model.frames_per_unit`.
    schedule : Schedule, optional
    rng : numpy.random.Generator, optional
        Draws the order of the windows, the corruption and the unpooling. Runs from the same seed
        on the same number of threads are equal to the bit.
    show_progress : bool
    checkpoint : Checkpoint, optional
        Where the state is saved, and where an interrupted run continues from, to the same bits.

    Raises
    ------
    DivergedError
        If a loss or a weight is not finite, with the stage, the epoch, the windows and the layer.
    CheckpointError
        If the checkpoint is of another run or cannot be written.
    """
    schedule = schedule or Schedule()
    rng = rng or np.random.default_rng(0)
    names = [*(f"layer {number + 1}" for number in range(len(model.layers))), "fine tuning"]
    history = History({name: [] for name in names}, dict.fromkeys(names, 0.0))
    callbacks: list[Callback] = [DivergenceCheck(ADVICE, checkpoint), history]
    if show_progress:
        callbacks.append(Progress())
    loop = Loop(model.parameters, rng, history, callbacks)
    if checkpoint is not None:
        bounds = [layer.bound for layer in model.layers]
        settings = schedule, bounds, rng.bit_generator.state
        checkpoint.attach(loop, fingerprint([*loop.parameters.values(), windows], *settings))

    inputs = windows
    for number, layer in enumerate(model.layers):
        loop.run(_task(model, inputs, schedule.layer, rng, number))
        if schedule.layer.epochs and layer is not model.layers[-1]:
            inputs = _encode(layer, inputs)
    loop.run(_task(model, windows, schedule.fine_tuning, rng, None))
    return history


def _task(
    model: Any, inputs: np.ndarray, stage: Stage, rng: np.random.Generator, layer: int | None
) -> Task:
    """The training of one layer, or (None) of all; its examples are the windows of `inputs`."""
    name, weights = "fine tuning", model.parameters
    if layer is not None:
        name, weights = f"layer {layer + 1}", model.layers[layer].parameters
    optimiser = make_optimiser(stage, weights)

    def step(chosen: np.ndarray, rate: float) -> float:
        return denoising_step(model, inputs[chosen], stage, rate, rng, optimiser, layer)

    def culprit(chosen: np.ndarray) -> str:
        windows = ", ".join(str(number + 1) for number in chosen[:8])
        finite = np.isfinite(inputs[chosen]).all()
        part = ", ".join(nonfinite(weights)) or f"the output of {name}"
        return f"{part if finite else 'the input'}, windows {windows}{', …' * (len(chosen) > 8)}"

    return Task(name, stage, len(inputs), True, step, culprit, optimiser)


def _encode(layer: ConvLayer, inputs: np.ndarray, at_once: int = 64) -> np.ndarray:
    """The layer's hidden units for clean input, `at_once` windows at a time to save memory."""
    windows, frames, _ = inputs.shape
    encoded = np.empty((windows, frames // 2, layer.b.size), dtype=inputs.dtype)
    for start in range(0, windows, at_once):
        part = slice(start, start + at_once)
        encoded[part], _ = layer.encode_with_pullback(inputs[part])
    return encoded
