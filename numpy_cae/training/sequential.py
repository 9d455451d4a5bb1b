"""The training of jang2018's network: clips, a prior and directions drawn anew at every step."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from numpy_cae.training.callback import Callback
from numpy_cae.training.checkpoint import Checkpoint, fingerprint
from numpy_cae.training.divergence import DivergenceCheck, SaveState, nonfinite
from numpy_cae.training.loop import Loop, Task
from numpy_cae.training.progress import Progress
from numpy_cae.training.schedule import SequenceSchedule, rate_at
from numpy_cae.training.step import make_optimiser, sequence_step

ADVICE = "a lower rate or a lower bound on the gradient's norm may keep it finite"

Draw = Callable[[np.random.Generator, int], np.ndarray]


@dataclass
class SequenceHistory(Callback):
    """What happened at each step, before it changed the weights.

    Attributes
    ----------
    reconstruction : list of float
        Mean squared error of the step's batch.
    discrepancy : list of float
        Sliced Wasserstein distance between its latent vectors and draws of the prior.
    norm : list of float
        Of the gradient, before it was clipped.
    seconds : float
        Of all steps together.
    """

    reconstruction: list[float] = field(default_factory=list)
    discrepancy: list[float] = field(default_factory=list)
    norm: list[float] = field(default_factory=list)
    seconds: float = 0.0

    def after_step(self, loop: Loop) -> None:
        """Note the time."""
        self.seconds = loop.at.seconds


@dataclass
class _Watch(Callback):
    """Calls a function with the number of steps made so far."""

    function: Callable[[int], None]

    def after_step(self, loop: Loop) -> None:
        self.function(loop.at.epoch * loop.steps + loop.at.step)


def train_sequential(
    model: Any,
    draw: Draw,
    schedule: SequenceSchedule | None = None,
    rng: np.random.Generator | None = None,
    show_progress: bool = True,
    each: Callable[[int], None] | None = None,
    checkpoint: Checkpoint | None = None,
) -> SequenceHistory:
    """Train the model in place.

    Parameters
    ----------
    model : SequentialAutoencoder, or what `fast.accelerate` makes of it
    draw : (rng, batch) -> (batch, T, features) array in the dtype of the model
        Returns normalised clips, others at every call.
    schedule : SequenceSchedule, optional
    rng : numpy.random.Generator, optional
        Draws the clips, the prior and the directions. Two runs from the same seed on the same
        number of threads are equal to the bit.
    show_progress : bool
    each : (step) -> None, optional
        Called after every step with the number of steps made so far; if it draws random numbers,
        it must use a generator of its own.
    checkpoint : Checkpoint, optional
        As in `train_autoencoder`; the data are identified by a first draw.

    Returns
    -------
    SequenceHistory

    Raises
    ------
    DivergedError
        If a loss or a weight is not finite, with the epoch and the step.
    CheckpointError
        If the checkpoint is of another run or cannot be written.
    """
    schedule = schedule or SequenceSchedule()
    rng = rng or np.random.default_rng(0)
    history = SequenceHistory()
    check = DivergenceCheck("step", ADVICE, checkpoint)
    callbacks: list[Callback] = [check, history, Progress(show_progress)]
    if each is not None:
        callbacks.append(_Watch(each))
    loop = Loop(model.weights, rng, history)
    if checkpoint is not None:
        callbacks.append(SaveState(checkpoint, check))
        # A copy draws, so that a run with a checkpoint draws the same as one without.
        data = [*model.weights.values(), draw(deepcopy(rng), schedule.batch)]
        loop.resume(checkpoint, fingerprint(data, schedule, rng.bit_generator.state))
    loop.run(_task(model, draw, schedule, rng, history), callbacks)
    return history


def _task(
    model: Any,
    draw: Draw,
    schedule: SequenceSchedule,
    rng: np.random.Generator,
    history: SequenceHistory,
) -> Task:
    """The training; an example is one step, which draws its clips itself."""
    optimiser = make_optimiser(schedule, model.weights)
    clips = np.zeros(0)

    def step(_: np.ndarray, rate: float) -> float:
        nonlocal clips
        clips = draw(rng, schedule.batch)
        losses, norm = sequence_step(model, clips, schedule, rate, rng, optimiser)
        history.reconstruction.append(losses.reconstruction)
        history.discrepancy.append(losses.discrepancy)
        history.norm.append(norm)
        return losses.total

    def culprit(_: np.ndarray) -> str:
        if not np.isfinite(clips).all():
            return "the clips"
        return ", ".join(nonfinite(model.weights)) or "the output of the network"

    return Task(
        name="sequences",
        epochs=schedule.epochs,
        count=schedule.steps,
        batch=1,
        draw_order=lambda: np.arange(schedule.steps),
        rate=partial(rate_at, schedule),
        step=step,
        optimiser=optimiser,
        culprit=culprit,
    )
