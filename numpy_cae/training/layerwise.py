"""Layer by layer, then all together: the training of holden2015, section 6.

The layers below encode the clean motion. The layer is trained to restore this encoding from a
corrupted copy (Vincent 2010). Fine tuning then trains the whole stack at once.
"""

from dataclasses import dataclass, field

import numpy as np

from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.training.checkpoint import Checkpoint, fingerprint
from numpy_cae.training.loop import Callback, Loop, Task
from numpy_cae.training.progress import DivergenceCheck, Progress, nonfinite
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
        self.seconds[loop.task.name] = loop.position.seconds


def train_autoencoder(
    model: ConvAutoencoder,
    windows: np.ndarray,
    schedule: Schedule | None = None,
    rng: np.random.Generator | None = None,
    show_progress: bool = True,
    checkpoint: Checkpoint | None = None,
) -> History:
    """Train a `ConvAutoencoder`, or what `fast.accelerate` makes of it, in place.

    `windows` (N, T, C) are normalised, in the dtype of the model; T is a multiple of
    `model.stride`. `rng` draws their order, the corruption and the unpooling: runs from
    the same seed on the same number of threads are equal to the bit. The state is saved in
    `checkpoint`, from which an interrupted run continues, to the same bits.

    Raises DivergedError if a loss or a weight is not finite, with the stage, the epoch, the windows
    and the layer, and CheckpointError if the checkpoint is of another run or cannot be written.
    """
    schedule = schedule or Schedule()
    rng = rng or np.random.default_rng(0)
    names = [*(f"layer {number + 1}" for number in range(len(model.layers))), "fine tuning"]
    history = History({name: [] for name in names}, dict.fromkeys(names, 0.0))
    shown = [Progress()] if show_progress else []
    callbacks = [DivergenceCheck(ADVICE, checkpoint), history, *shown]
    loop = Loop(model.parameters, rng, history, callbacks)
    if checkpoint is not None:
        settings = schedule, [layer.bound for layer in model.layers], rng.bit_generator.state
        checkpoint.attach(loop, fingerprint([*loop.parameters.values(), windows], *settings))

    inputs = windows
    for number, layer in enumerate(model.layers):
        loop.run(_task(model, inputs, schedule.layer, number, rng))
        if schedule.layer.epochs and layer is not model.layers[-1]:
            inputs = _encode(layer, inputs)
    loop.run(_task(model, windows, schedule.fine_tuning, None, rng))
    return history


def _task(
    model: ConvAutoencoder, x: np.ndarray, stage: Stage, layer: int | None, rng: np.random.Generator
) -> Task:
    """The training of one layer, or (None) of all; its examples are the windows of x."""
    name, weights = "fine tuning", model.parameters
    if layer is not None:
        name, weights = f"layer {layer + 1}", model.layers[layer].parameters
    optimiser = make_optimiser(stage, weights)

    def step(chosen: np.ndarray, rate: float) -> float:
        return denoising_step(model, x[chosen], stage, rate, rng, optimiser, layer)

    def nonfinite_part(chosen: np.ndarray) -> str:
        windows = ", ".join(str(number + 1) for number in chosen[:8])
        finite = np.isfinite(x[chosen]).all()
        part = ", ".join(nonfinite(weights)) or f"the output of {name}"
        return f"{part if finite else 'the input'}, windows {windows}{', …' * (len(chosen) > 8)}"

    return Task(name, stage, len(x), True, step, nonfinite_part, optimiser)


def _encode(layer: ConvLayer, inputs: np.ndarray, at_once: int = 64) -> np.ndarray:
    """The layer's hidden units for clean input, `at_once` windows at a time to save memory."""
    parts = [inputs[start : start + at_once] for start in range(0, len(inputs), at_once)]
    return np.concatenate([layer.encode_with_pullback(part)[0] for part in parts])
