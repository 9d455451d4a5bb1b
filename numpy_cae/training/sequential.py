"""The training of jang2018's network: clips, a prior and directions drawn anew at every step."""

from collections.abc import Callable
from copy import deepcopy

import numpy as np

from numpy_cae.models import Losses, SequentialAutoencoder
from numpy_cae.training.checkpoint import Checkpoint
from numpy_cae.training.divergence import require_finite
from numpy_cae.training.optimisers import Adam, Sgd, clip_norm, make_optimiser
from numpy_cae.training.schedule import SequenceSchedule, rate_at
from numpy_cae.training.state import TrainingState

Draw = Callable[[np.random.Generator, int], np.ndarray]
"""Takes a generator and a number B, and returns B clips (B, T, features), others at each call."""


def train_sequential(
    model: SequentialAutoencoder,
    draw: Draw,
    schedule: SequenceSchedule | None = None,
    rng: np.random.Generator | int = 0,
    report: Callable[[TrainingState], None] | None = None,
    checkpoint: Checkpoint | None = None,
) -> TrainingState:
    """Train a `SequentialAutoencoder` in place.

    Parameters
    ----------
    model : SequentialAutoencoder
        Or what `fast.accelerate` makes of it, which trains faster.
    draw : function (rng, B) -> (B, T, features) array
        Draws other normalised clips, in the dtype of the model, at every call. A hash of the
        first ones tells `checkpoint` whether the data are the same.
    schedule : SequenceSchedule, optional
        One of `SEQUENCE_RECIPES`; "paper" by default.
    rng, report, checkpoint
        As in `train_autoencoder`; `rng` draws the clips, the prior and the directions.

    Returns
    -------
    state : TrainingState
        Its `losses` have the mean squared error ("reconstruction") and the sliced Wasserstein
        distance to the prior ("discrepancy") of every step.

    Raises
    ------
    DivergedError, CheckpointError
        As `train_autoencoder`.

    Examples
    --------
    >>> def waves(rng, count):
    ...     phases = rng.uniform(0, 6, size=(count, 1, 1))
    ...     return np.sin(np.arange(8)[:, None] + phases).astype(np.float32)
    >>> model = SequentialAutoencoder(features=1, hidden=8, latent=2)
    >>> state = train_sequential(model, waves, SequenceSchedule(epochs=2, steps=20, batch=16))
    >>> len(state.losses["reconstruction"])
    40
    """
    schedule = schedule or SequenceSchedule()
    rng = np.random.default_rng(rng)
    state = TrainingState()
    if checkpoint is not None:
        # A copy draws, so that a run with a checkpoint draws the same as one without.
        clips = draw(deepcopy(rng), schedule.batch)
        checkpoint.begin_run(state, rng, model.weights, clips, schedule)

    optimiser = make_optimiser(schedule, model.weights)
    state.begin_stage("sequences", schedule.epochs, schedule.steps)
    if checkpoint is not None:
        checkpoint.begin_stage(optimiser.arrays)

    for epoch in range(state.epoch, schedule.epochs):
        for step in range(state.step, schedule.steps):
            clips = draw(rng, schedule.batch)
            rate = rate_at(schedule, epoch, step, schedule.steps)
            losses = take_step(model, clips, schedule, optimiser, rate, rng)
            require_finite(losses.total, model.weights, clips, rate, state, checkpoint)
            state.losses.setdefault("reconstruction", []).append(losses.reconstruction)
            state.losses.setdefault("discrepancy", []).append(losses.discrepancy)
            state.count_step(losses.total, len(clips))
            if report is not None:
                report(state)
            if checkpoint is not None:
                checkpoint.save_when_due(state)
    state.end_stage()
    return state


def take_step(
    model: SequentialAutoencoder,
    clips: np.ndarray,
    schedule: SequenceSchedule,
    optimiser: Sgd | Adam,
    rate: float,
    rng: np.random.Generator,
) -> Losses:
    """Take one step, and return the losses before it; if they are not finite, no weight is changed.

    Points of the prior and directions are drawn anew.
    """
    prior = rng.standard_normal((len(clips), model.latent)).astype(clips.dtype)
    directions = unit_directions(schedule.directions, model.latent, rng, clips.dtype)
    losses, gradients = model.loss_and_gradients(clips, prior, directions, schedule.weight)
    if np.isfinite(losses.total):
        clip_norm(list(gradients.values()), schedule.norm)
        optimiser.update(gradients.values(), rate)
    return losses


def unit_directions(
    count: int, dimensions: int, rng: np.random.Generator, dtype: np.dtype | type = np.float32
) -> np.ndarray:
    """Random directions, uniformly distributed: those of vectors of independent normal numbers.

    Parameters
    ----------
    count, dimensions : int
    rng : numpy.random.Generator
    dtype : float32 or float64

    Returns
    -------
    directions : (count, dimensions) array
        Rows of length 1.

    Examples
    --------
    >>> directions = unit_directions(4, 3, np.random.default_rng(0))
    >>> np.linalg.norm(directions, axis=1).round(5)
    array([1., 1., 1., 1.], dtype=float32)
    """
    drawn = rng.standard_normal((count, dimensions))
    return (drawn / np.linalg.norm(drawn, axis=1, keepdims=True)).astype(dtype)
