"""The training of jang2018's network: clips, a prior and directions drawn anew at every step."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training.clipping import clip_norm
from numpy_cae.training.directions import unit_directions
from numpy_cae.training.layerwise import DivergedError
from numpy_cae.training.progress import Progress
from numpy_cae.training.schedule import SequenceSchedule
from numpy_cae.training.sgd import decayed_rate, descend

Draw = Callable[[np.random.Generator, int], np.ndarray]


@dataclass
class SequenceHistory:
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


def train_sequential(
    model: SequentialAutoencoder,
    draw: Draw,
    schedule: SequenceSchedule | None = None,
    rng: np.random.Generator | None = None,
    show_progress: bool = True,
    each: Callable[[int], None] | None = None,
) -> SequenceHistory:
    """Train the model in place.

    Parameters
    ----------
    model : SequentialAutoencoder
    draw : (rng, batch) -> (batch, T, features) array in the dtype of the model
        Gives normalised clips, others at every call.
    schedule : SequenceSchedule, optional
    rng : numpy.random.Generator, optional
        Draws the clips, the prior and the directions. Two runs from the same seed on the same
        number of threads are equal to the bit.
    show_progress : bool
    each : (step) -> None, optional
        Called after every step with the number of steps made so far; what it measures of the model
        must draw from a generator of its own.

    Returns
    -------
    SequenceHistory

    Raises
    ------
    DivergedError
        If a loss is not finite, with the epoch.
    """
    schedule = schedule or SequenceSchedule()
    rng = rng or np.random.default_rng(0)
    history = SequenceHistory()
    progress = Progress("sequences", schedule.epochs, schedule.steps, show_progress)
    start = time.perf_counter()
    try:
        for epoch in range(schedule.epochs):
            rate = decayed_rate(schedule.rate, schedule.decay, epoch)
            total = 0.0
            for step in range(schedule.steps):
                total += _step(model, draw, schedule, rate, rng, history, epoch)
                progress.step()
                if each is not None:
                    each(epoch * schedule.steps + step + 1)
            progress.epoch(epoch, total / schedule.steps)
    finally:
        progress.close()
    history.seconds = time.perf_counter() - start
    return history


def _step(
    model: SequentialAutoencoder,
    draw: Draw,
    schedule: SequenceSchedule,
    rate: float,
    rng: np.random.Generator,
    history: SequenceHistory,
    epoch: int,
) -> float:
    """Draw, compare, clip, descend; returns the loss."""
    x = draw(rng, schedule.batch)
    prior = rng.standard_normal((len(x), model.latent)).astype(x.dtype)
    directions = unit_directions(schedule.directions, model.latent, rng, x.dtype)
    losses, gradients = model.loss_and_gradients(x, prior, directions, schedule.weight)
    if not np.isfinite(losses.total):
        raise DivergedError(
            f"sequences, epoch {epoch + 1}: the loss is {losses.total} at rate {rate:.4g}; "
            "a lower rate or a lower bound on the gradient's norm may keep it finite"
        )
    history.reconstruction.append(losses.reconstruction)
    history.discrepancy.append(losses.discrepancy)
    history.norm.append(clip_norm(list(gradients.values()), schedule.norm))
    descend(model.weights.values(), gradients.values(), rate)
    return losses.total
