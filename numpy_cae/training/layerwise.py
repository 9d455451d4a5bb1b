"""Layer by layer, then all together: the training of holden2015, section 6.

Each layer learns to reproduce what the trained layers below it make of the clean motion, from a
corrupted copy of that (Vincent 2010). Fine tuning then trains the whole stack at once, from
corrupted motion to clean motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from numpy_cae.models import ConvLayer
from numpy_cae.training.callback import Callback
from numpy_cae.training.checkpoint import Checkpoint, fingerprint
from numpy_cae.training.divergence import DivergenceCheck, SaveState, nonfinite
from numpy_cae.training.loop import Loop, Task
from numpy_cae.training.progress import Progress
from numpy_cae.training.schedule import Schedule, Stage, rate_at
from numpy_cae.training.step import denoising_step, make_optimiser

ADVICE = "a lower rate or smaller values of the input (--rate, --rms) may keep it finite"


@dataclass
class History(Callback):
    """What happened in each stage: "layer 1", …, "fine tuning".

    Attributes
    ----------
    losses : dict
        Name of a stage to the mean loss of each of its epochs.
    seconds : dict
        Name of a stage to the time that its epochs took.
    """

    losses: dict[str, list[float]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    def begin(self, loop: Loop) -> None:
        """List the stage."""
        self.losses.setdefault(loop.task.name, [])
        self.seconds.setdefault(loop.task.name, 0.0)

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
        The paper's by default.
    rng : numpy.random.Generator, optional
        Draws the order of the windows, the corruption and the unpooling. Two runs from the same
        seed on the same number of threads are equal to the bit.
    show_progress : bool
    checkpoint : Checkpoint, optional
        Where the state is saved, and where an interrupted run continues from, to the same bits.

    Returns
    -------
    History

    Raises
    ------
    DivergedError
        If a loss or a weight is not finite, with the stage, the epoch, the windows and the layer.
    CheckpointError
        If the checkpoint is of another run or cannot be written.
    """
    schedule = schedule or Schedule()
    rng = rng or np.random.default_rng(0)
    weights = _weights(dict(enumerate(model.layers)))
    history = History()
    check = DivergenceCheck("window", ADVICE, checkpoint)
    callbacks: list[Callback] = [check, history, Progress(show_progress)]
    loop = Loop(weights, rng, history)
    if checkpoint is not None:
        callbacks.append(SaveState(checkpoint, check))
        bounds = [layer.bound for layer in model.layers]
        data = [*weights.values(), windows]
        loop.resume(checkpoint, fingerprint(data, schedule, bounds, rng.bit_generator.state))

    inputs = windows
    for number, layer in enumerate(model.layers):
        loop.run(_task(model, inputs, schedule.layer, rng, number), callbacks)
        if schedule.layer.epochs and layer is not model.layers[-1]:
            inputs = _encode(layer, inputs)
    loop.run(_task(model, windows, schedule.fine_tuning, rng, None), callbacks)
    return history


def _task(
    model: Any, inputs: np.ndarray, stage: Stage, rng: np.random.Generator, layer: int | None
) -> Task:
    """The training of one layer, or (None) of all: each window once an epoch, in a new order."""
    trained = dict(enumerate(model.layers))
    if layer is not None:
        trained = {layer: model.layers[layer]}
    optimiser = make_optimiser(stage, _weights(trained))
    return Task(
        name="fine tuning" if layer is None else f"layer {layer + 1}",
        epochs=stage.epochs,
        count=len(inputs),
        batch=stage.batch,
        draw_order=lambda: rng.permutation(len(inputs)),
        rate=partial(rate_at, stage),
        step=lambda chosen, rate: denoising_step(
            model, inputs[chosen], stage, rate, rng, optimiser, layer
        ),
        optimiser=optimiser,
        culprit=lambda chosen: _first_nonfinite(model, inputs[chosen], layer),
    )


def _weights(layers: dict[int, ConvLayer]) -> dict[str, np.ndarray]:
    """The weights of layers by name: "w1", "b1", …; the layers are numbered from 0."""
    return {
        f"{letter}{number + 1}": array
        for number, layer in layers.items()
        for letter, array in layer.parameters.items()
    }


def _encode(layer: ConvLayer, inputs: np.ndarray, at_once: int = 64) -> np.ndarray:
    """The layer's hidden units for clean input, `at_once` windows at a time to save memory."""
    windows, frames, _ = inputs.shape
    encoded = np.empty((windows, frames // 2, layer.b.size), dtype=inputs.dtype)
    for start in range(0, windows, at_once):
        part = slice(start, start + at_once)
        encoded[part], _ = layer.encode_with_pullback(inputs[part])
    return encoded


def _first_nonfinite(model: Any, x: np.ndarray, layer: int | None) -> str:
    """The first part of the network that is not finite, on the path of the input x.

    tanh keeps what the encoders return within ±1 if the weights are finite; what the decoders
    return has no bound, so they are checked from the top down.
    """
    if not np.isfinite(x).all():
        return "the input"
    if layer is not None:
        return f"layer {layer + 1}"
    names = nonfinite(_weights(dict(enumerate(model.layers))))
    if names:
        return f"the weights {names[0]}"
    with np.errstate(all="ignore"):
        for each in model.layers:
            x, _ = each.encode_with_pullback(x)
        for number, each in reversed(list(enumerate(model.layers, start=1))):
            x, _ = each.decode_with_pullback(x)
            if not np.isfinite(x).all():
                return f"the output of decoding layer {number}"
    return "the gradient of the last step"
