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
from numpy_cae.training.checkpoint import Checkpoint, State, run_of
from numpy_cae.training.corruption import corrupt
from numpy_cae.training.divergence import DivergedError, first_layer_gone, gone, shown
from numpy_cae.training.progress import Progress
from numpy_cae.training.schedule import EVEN, Schedule, Stage
from numpy_cae.training.sgd import decayed_rate, descend, descend_with_momentum

ADVICE = "a lower rate or smaller values of the input (--rate, --rms) may keep it finite"


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
    checkpoint: Checkpoint | None = None,
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
    checkpoint : Checkpoint, optional
        Where the state is kept after every epoch and as often as it says, and where an
        interrupted run is gone on from: to the same bits.

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
    model.thaw()
    run = _Run(model, rng, show_progress, checkpoint)
    begin = run.resumed(windows, schedule)
    inputs = windows
    for number, layer in enumerate((*range(len(model.layers)), None)):
        if number >= begin.stage:
            stage = schedule.fine_tuning if layer is None else schedule.layer
            state = begin if number == begin.stage else run.state(number)
            run.train(windows if layer is None else inputs, stage, layer, state)
        if layer is not None and layer + 1 < len(model.layers):
            inputs = _encoded(model.layers[layer], inputs)
    return run.history


@dataclass
class _Run:
    """One training, from its beginning or from where a checkpoint says."""

    model: ConvAutoencoder
    rng: np.random.Generator
    show_progress: bool
    checkpoint: Checkpoint | None
    history: History = field(default_factory=History)
    velocities: dict[str, np.ndarray] = field(init=False)

    def __post_init__(self):
        self.velocities = {name: np.zeros_like(w) for name, w in self.weights().items()}

    def weights(self) -> dict[str, np.ndarray]:
        return {
            f"{letter}{number}": array
            for number, layer in enumerate(self.model.layers, start=1)
            for letter, array in layer.parameters.items()
        }

    def state(self, stage: int, epoch: int = 0, step: int = 0, total: float = 0.0) -> State:
        """How far it is now."""
        return State(
            self.weights() | self._named_velocities(),
            self.rng.bit_generator.state,
            stage,
            epoch,
            step,
            total,
            history={"losses": self.history.losses, "seconds": self.history.seconds},
        )

    def _named_velocities(self) -> dict[str, np.ndarray]:
        return {f"velocity of {name}": array for name, array in self.velocities.items()}

    def resumed(self, windows: np.ndarray, schedule: Schedule) -> State:
        """Where to begin; the weights, the random numbers and the history are brought there."""
        kept = None
        if self.checkpoint is not None:
            own = [*self.weights().values(), windows]
            bounds = [layer.bound for layer in self.model.layers]
            name = run_of(own, schedule, bounds, self.rng.bit_generator.state)
            kept = self.checkpoint.begin(name)
        if kept is None:
            return self.state(0)
        for name, array in (self.weights() | self._named_velocities()).items():
            array[...] = kept.weights[name]
        self.rng.bit_generator.state = kept.rng
        self.history = History(**kept.history)
        return kept

    def train(self, inputs: np.ndarray, stage: Stage, layer: int | None, at: State) -> None:
        """One stage: a layer, or (None) all of them."""
        name = "fine tuning" if layer is None else f"layer {layer + 1}"
        steps = -(-len(inputs) // stage.batch)
        losses = self.history.losses.setdefault(name, [])
        before = self.history.seconds.setdefault(name, 0.0)
        start = time.perf_counter()
        progress = Progress(name, stage.epochs, steps, self.show_progress)
        if at.epoch or at.step:
            progress.begin_at(at.epoch * steps + at.step)
        else:
            for velocity in self.velocities.values():
                velocity[...] = 0
        try:
            for epoch in range(at.epoch, stage.epochs):
                losses.append(self._epoch(inputs, stage, layer, at, name, epoch, progress))
                self.history.seconds[name] = before + time.perf_counter() - start
                at = self.state(at.stage, epoch + 1)
                if self.checkpoint is not None:
                    self.checkpoint.save(at)
                progress.epoch(epoch, losses[-1])
        except DivergedError as error:
            if self.checkpoint is not None:
                error.kept = self.checkpoint.said()
            raise
        finally:
            progress.close()

    def _epoch(
        self,
        inputs: np.ndarray,
        stage: Stage,
        layer: int | None,
        at: State,
        name: str,
        epoch: int,
        progress: Progress,
    ) -> float:
        """Every window once, in a new order, `batch` at a time; returns the mean loss."""
        rate = decayed_rate(stage.rate, stage.decay, epoch)
        order = at.order if at.step else self.rng.permutation(len(inputs))
        batches = _batches(order, stage.batch)
        total = at.total
        for step, chosen in enumerate(batches[at.step :], start=at.step):
            x = inputs[chosen]
            loss = _step(self.model, x, stage, rate, self.rng, layer, self.velocities)
            if not np.isfinite(loss):
                raise DivergedError(
                    f"{name}, epoch {epoch + 1}, {shown(chosen)}",
                    first_layer_gone(self.model, x, layer),
                    f"the loss is {loss} at rate {rate:.4g}",
                    ADVICE,
                )
            total += loss * len(chosen)
            progress.step()
            if self.checkpoint is not None and self.checkpoint.is_due():
                state = self.state(at.stage, epoch, step + 1, total)
                state.order = order
                self._require_finite(name, epoch, rate)
                self.checkpoint.save(state)
        self._require_finite(name, epoch, rate)
        return total / len(inputs)

    def _require_finite(self, name: str, epoch: int, rate: float) -> None:
        """A loss can be finite and the step after it not: such weights are never kept."""
        lost = gone(self.weights())
        if lost:
            raise DivergedError(
                f"{name}, epoch {epoch + 1}",
                f"{lost[0]} (layer {lost[0][1:]})",
                f"weights are no longer finite at rate {rate:.4g}",
                ADVICE,
            )


def _batches(order: np.ndarray, batch: int) -> list[np.ndarray]:
    """The windows in this order, `batch` at a time."""
    return [order[start : start + batch] for start in range(0, len(order), batch)]


def _step(
    model: ConvAutoencoder,
    x: np.ndarray,
    stage: Stage,
    rate: float,
    rng: np.random.Generator,
    layer: int | None,
    velocities: dict[str, np.ndarray],
) -> float:
    """Corrupt, compare, descend: one step on one batch, for one layer or (None) for all."""
    corrupted = corrupt(x, stage.zeroed, stage.rescaled, rng)
    numbers = range(len(model.layers)) if layer is None else [layer]
    first = _drawn_masks(model, x, stage, layer, rng)
    loss, gradients = model.loss_and_gradients(x, corrupted, stage.alpha, first, layer)
    for number, gradient in zip(numbers, gradients, strict=True):
        parameters = model.layers[number].parameters
        if stage.momentum:
            own = [velocities[f"{letter}{number + 1}"] for letter in parameters]
            descend_with_momentum(parameters.values(), own, gradient, rate, stage.momentum)
        else:
            descend(parameters.values(), gradient, rate)
    return loss


def _drawn_masks(
    model: ConvAutoencoder,
    x: np.ndarray,
    stage: Stage,
    layer: int | None,
    rng: np.random.Generator,
) -> list[np.ndarray] | None:
    """A mask for each layer in training, lowest first; None for unpooling evenly."""
    if stage.unpooling == EVEN or (stage.unpooling is None and layer is None):
        return None
    layers = model.layers if layer is None else [model.layers[layer]]
    return [_drawn_mask(x[:, :: 2**k], each.b.size, rng) for k, each in enumerate(layers)]


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
