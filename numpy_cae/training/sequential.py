"""The training of jang2018's network: clips, a prior and directions drawn anew at every step."""

from __future__ import annotations

import time
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training.checkpoint import Checkpoint, State, run_of
from numpy_cae.training.clipping import clip_norm
from numpy_cae.training.directions import unit_directions
from numpy_cae.training.divergence import DivergedError, gone
from numpy_cae.training.progress import Progress
from numpy_cae.training.schedule import SequenceSchedule
from numpy_cae.training.sgd import decayed_rate, descend_with_momentum

ADVICE = "a lower rate or a lower bound on the gradient's norm may keep it finite"

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
    checkpoint: Checkpoint | None = None,
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
    checkpoint : Checkpoint, optional
        As in `train_autoencoder`; clips are told apart by a first draw.

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
    velocities = {name: np.zeros_like(array) for name, array in model.weights.items()}
    at = _resumed(model, velocities, draw, schedule, rng, history, checkpoint)
    progress = Progress("sequences", schedule.epochs, schedule.steps, show_progress)
    if at.epoch or at.step:
        progress.begin_at(at.epoch * schedule.steps + at.step)
    start, before = time.perf_counter(), history.seconds
    try:
        for epoch in range(at.epoch, schedule.epochs):
            rate = decayed_rate(schedule.rate, schedule.decay, epoch)
            done, total = (at.step, at.total) if epoch == at.epoch else (0, 0.0)
            for step in range(done, schedule.steps):
                where = f"sequences, epoch {epoch + 1}, step {step + 1}"
                total += _step(model, velocities, draw, schedule, rate, rng, history, where)
                progress.step()
                if each is not None:
                    each(epoch * schedule.steps + step + 1)
                last = step + 1 == schedule.steps
                history.seconds = before + time.perf_counter() - start
                if checkpoint is not None and (last or checkpoint.is_due()):
                    state = _state(model, velocities, rng, history, epoch, step + 1, total)
                    checkpoint.save(state)
            progress.epoch(epoch, total / schedule.steps)
    except DivergedError as error:
        if checkpoint is not None:
            error.kept = checkpoint.said()
        raise
    finally:
        progress.close()
    return history


def _kept(model: SequentialAutoencoder, velocities: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The arrays that the rest of the training depends on."""
    named = {f"velocity of {name}": array for name, array in velocities.items()}
    return dict(model.weights) | named


def _state(
    model: SequentialAutoencoder,
    velocities: dict[str, np.ndarray],
    rng: np.random.Generator,
    history: SequenceHistory,
    epoch: int = 0,
    step: int = 0,
    total: float = 0.0,
) -> State:
    """How far it is now; what is kept of it is written before the next step changes it."""
    drawn, measured = rng.bit_generator.state, vars(history)
    return State(_kept(model, velocities), drawn, 0, epoch, step, total, history=measured)


def _resumed(
    model: SequentialAutoencoder,
    velocities: dict[str, np.ndarray],
    draw: Draw,
    schedule: SequenceSchedule,
    rng: np.random.Generator,
    history: SequenceHistory,
    checkpoint: Checkpoint | None,
) -> State:
    """Where to begin; the weights, the random numbers and the history are brought there."""
    kept = None
    if checkpoint is not None:
        # A copy draws, so that a run with a checkpoint draws the same as one without.
        clips = draw(deepcopy(rng), schedule.batch)
        own = [*model.weights.values(), clips]
        kept = checkpoint.begin(run_of(own, schedule, rng.bit_generator.state))
    if kept is None:
        return _state(model, velocities, rng, history)
    for name, array in _kept(model, velocities).items():
        array[...] = kept.weights[name]
    rng.bit_generator.state = kept.rng
    vars(history).update(kept.history)
    return kept


def _step(
    model: SequentialAutoencoder,
    velocities: dict[str, np.ndarray],
    draw: Draw,
    schedule: SequenceSchedule,
    rate: float,
    rng: np.random.Generator,
    history: SequenceHistory,
    where: str,
) -> float:
    """Draw, compare, clip, descend; returns the loss."""
    x = draw(rng, schedule.batch)
    if schedule.posture:
        shape = (len(x), 1, x.shape[2])
        x = x + schedule.posture * rng.standard_normal(shape, dtype=x.dtype)
    prior = rng.standard_normal((len(x), model.latent)).astype(x.dtype)
    directions = unit_directions(schedule.directions, model.latent, rng, x.dtype)
    losses, gradients = model.loss_and_gradients(x, prior, directions, schedule.weight)
    if not np.isfinite(losses.total):
        problem = f"the loss is {losses.total} at rate {rate:.4g}"
        culprit = "what the network makes of them" if np.isfinite(x).all() else "the clips"
        raise DivergedError(where, culprit, problem, ADVICE)
    history.reconstruction.append(losses.reconstruction)
    history.discrepancy.append(losses.discrepancy)
    history.norm.append(clip_norm(list(gradients.values()), schedule.norm))
    descend_with_momentum(
        model.weights.values(), velocities.values(), gradients.values(), rate, schedule.momentum
    )
    lost = gone(model.weights)
    if lost:
        problem = f"weights are no longer finite at rate {rate:.4g}"
        raise DivergedError(where, lost[0], problem, ADVICE)
    return losses.total
