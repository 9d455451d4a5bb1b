"""The training of jang2018's network: clips, a prior and directions drawn anew at every step."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training.checkpoint import Checkpoint, fingerprint
from numpy_cae.training.loop import Loop, Task
from numpy_cae.training.progress import DivergenceCheck, Progress, nonfinite
from numpy_cae.training.schedule import SequenceSchedule
from numpy_cae.training.step import make_optimiser, sequence_step

ADVICE = "a lower rate or a lower bound on the gradient's norm may keep it finite"


@dataclass
class SequenceHistory:
    """For each step: the mean squared error of its batch, the sliced Wasserstein distance from its
    latent vectors to draws of the prior, and the norm of the gradient before it was clipped."""

    reconstruction: list[float] = field(default_factory=list)
    discrepancy: list[float] = field(default_factory=list)
    norm: list[float] = field(default_factory=list)
    seconds: float = 0.0


def train_sequential(
    model: SequentialAutoencoder,
    draw: Callable[[np.random.Generator, int], np.ndarray],
    schedule: SequenceSchedule | None = None,
    rng: np.random.Generator | None = None,
    show_progress: bool = True,
    each: Callable[[int], None] | None = None,
    checkpoint: Checkpoint | None = None,
) -> SequenceHistory:
    """Train a `SequentialAutoencoder`, or what `fast.accelerate` makes of it, in place.

    `draw(rng, batch)` returns other normalised clips (batch, T, features) at every call, in the
    dtype of the model. `rng` draws the clips, the prior and the directions. `each` is called after
    every step with the number of steps made so far; it must not draw from `rng`. Checkpoints and
    errors are as in `train_autoencoder`; a checkpoint identifies the data by a first draw.
    """
    schedule = schedule or SequenceSchedule()
    rng = rng or np.random.default_rng(0)
    history = SequenceHistory()
    shown = [Progress()] if show_progress else []
    loop = Loop(model.weights, rng, history, [DivergenceCheck(ADVICE, checkpoint), *shown])
    optimiser = make_optimiser(schedule, model.weights)
    clips = np.zeros(0)

    def step(_: np.ndarray, rate: float) -> float:
        nonlocal clips
        clips = draw(rng, schedule.batch)
        losses, norm = sequence_step(model, clips, schedule, rate, rng, optimiser)
        history.reconstruction.append(losses.reconstruction)
        history.discrepancy.append(losses.discrepancy)
        history.norm.append(norm)
        if each is not None:
            each(len(history.norm))
        return losses.total

    def nonfinite_part(_: np.ndarray) -> str:
        if not np.isfinite(clips).all():
            return "the clips"
        return ", ".join(nonfinite(model.weights)) or "the output of the network"

    if checkpoint is not None:
        # A copy draws, so that a run with a checkpoint draws the same as one without.
        data = [*model.weights.values(), draw(deepcopy(rng), schedule.batch)]
        checkpoint.attach(loop, fingerprint(data, schedule, rng.bit_generator.state))
    count = schedule.steps * schedule.batch  # an example is a clip, which the step draws itself
    loop.run(Task("sequences", schedule, count, False, step, nonfinite_part, optimiser))
    history.seconds = loop.position.seconds
    return history
