"""Layer by layer, then all together: the training of holden2015, section 6.

To train a layer, the layers before it first encode the clean motion; the layer then learns to
restore this encoding from a corrupted copy (Vincent 2010). Fine tuning then trains the whole stack
at once. What is random in a step is drawn by `corruption`.
"""

from collections.abc import Callable
from itertools import chain
from typing import NamedTuple

import numpy as np

from numpy_cae.models import ConvAutoencoder
from numpy_cae.training.checkpoint import Checkpoint
from numpy_cae.training.corruption import corrupt, unpooling_mask
from numpy_cae.training.divergence import require_finite
from numpy_cae.training.optimisers import Adam, Sgd, clip_norm, make_optimiser
from numpy_cae.training.schedule import Schedule, Stage, rate_at
from numpy_cae.training.state import TrainingState
from numpy_cae.training.windows import Windows


def train_autoencoder(
    model: ConvAutoencoder,
    windows: np.ndarray | Windows,
    schedule: Schedule | None = None,
    rng: np.random.Generator | int = 0,
    report: Callable[[TrainingState], None] | None = None,
    checkpoint: Checkpoint | None = None,
) -> TrainingState:
    """Train a `ConvAutoencoder` in place.

    Runs with one seed on the same number of threads are bit-identical, and so is a run that was
    interrupted and continued from its checkpoint.

    Parameters
    ----------
    model : ConvAutoencoder
        Or what `fast.accelerate` makes of it, which trains faster.
    windows : (N, T, C) array of float, or Windows
        Normalised motion in the dtype of the model; T is a multiple of `model.stride`.
    schedule : Schedule, optional
        The paper's by default; see `recipe`.
    rng : numpy.random.Generator or int
        Or its seed. It draws the order of the windows, the corruption and the unpooling.
    report : function (TrainingState), optional
        Called after every step, such as `ProgressPrinter()`; it must not draw from `rng`.
    checkpoint : Checkpoint, optional
        Saves the state; an interrupted run continues from it.

    Returns
    -------
    state : TrainingState
        Its `losses` are those of every epoch, by stage.

    Raises
    ------
    DivergedError
        If a loss or a weight is not finite.
    CheckpointError
        If the checkpoint is of another run or cannot be written.

    Examples
    --------
    >>> from numpy_cae.training import Stage
    >>> windows = np.sin(np.arange(320) / 9).reshape(4, 16, 5).astype(np.float32)
    >>> model = ConvAutoencoder(features=5, filters=(6,), taps=3)
    >>> schedule = Schedule(layer=Stage(epochs=3), fine_tuning=Stage(epochs=0))
    >>> losses = train_autoencoder(model, windows, schedule).losses["layer 1"]
    >>> len(losses), losses[-1] < losses[0]
    (3, True)
    """
    schedule = schedule or Schedule()
    rng = np.random.default_rng(rng)
    weights = model.parameters
    state = TrainingState()
    if checkpoint is not None:
        bounds = [layer.bound for layer in model.layers]
        checkpoint.begin_run(state, rng, weights, windows, schedule, bounds)

    for part in parts_of_training(model, schedule)[state.stage :]:
        stage = part.stage
        x = input_of(part, model, windows)
        optimiser = make_optimiser(stage, parameters_of(part, model))
        order = np.zeros(len(x), dtype=int)
        state.begin_stage(part.name, stage.epochs, steps=-(-len(x) // stage.batch))
        if checkpoint is not None:
            checkpoint.begin_stage(optimiser.arrays | {"order": order})

        for epoch in range(state.epoch, stage.epochs):
            if state.step == 0:
                order[...] = rng.permutation(len(x))

            for step in range(state.step, state.steps):
                batch = x[order[step * stage.batch : (step + 1) * stage.batch]]
                rate = rate_at(stage, epoch, step, state.steps)
                loss = take_step(model, part, batch, optimiser, rate, rng)
                require_finite(loss, weights, batch, rate, state, checkpoint)
                state.count_step(loss, len(batch))
                if report is not None:
                    report(state)
                if checkpoint is not None:
                    checkpoint.save_when_due(state)
        state.end_stage()
    return state


class Part(NamedTuple):
    """A part of the training: one layer by itself, or all layers together."""

    name: str  # "layer 1", "layer 2", …, "fine tuning"
    layer: int | None  # index of the layer; None for all layers
    stage: Stage


def parts_of_training(model: ConvAutoencoder, schedule: Schedule) -> list[Part]:
    """Layer by layer, then all together; without the parts that have no epochs."""
    parts = [Part(f"layer {n + 1}", n, schedule.layer) for n in range(len(model.layers))]
    parts.append(Part("fine tuning", None, schedule.fine_tuning))
    return [part for part in parts if part.stage.epochs]


def take_step(
    model: ConvAutoencoder,
    part: Part,
    x: np.ndarray,
    optimiser: Sgd | Adam,
    rate: float,
    rng: np.random.Generator,
) -> float:
    """Take one step, and return the loss before it; if it is not finite, no weight is changed.

    The loss is that of restoring the batch x from a corrupted copy, equation 3. The paper unpools
    at random while one layer is trained, and evenly while all are.
    """
    stage = part.stage
    corrupted = corrupt(x, stage, rng)
    first = None
    if part.layer is not None:
        first = [unpooling_mask(x, model.layers[part.layer].b.size, rng)]
    loss, gradients = model.loss_and_gradients(x, corrupted, stage.alpha, first, part.layer)
    if np.isfinite(loss):
        arrays = list(chain.from_iterable(gradients))  # dw1, db1, dw2, db2, … as the parameters
        if stage.norm is not None:
            clip_norm(arrays, stage.norm)
        optimiser.update(arrays, rate)
    return loss


def parameters_of(part: Part, model: ConvAutoencoder) -> dict[str, np.ndarray]:
    """The arrays that a part of the training changes, by name."""
    if part.layer is None:
        return model.parameters
    layer = model.layers[part.layer]
    return {"w": layer.w, "b": layer.b}


def input_of(
    part: Part, model: ConvAutoencoder, windows: np.ndarray | Windows
) -> np.ndarray | Windows:
    """Clean windows or, for a layer but the lowest, what the layers below it make of them.

    They encode 64 windows at a time to save memory.
    """
    if not part.layer:
        return windows
    starts = range(0, len(windows), 64)
    return np.concatenate([model.encode(windows[n : n + 64], part.layer) for n in starts])
