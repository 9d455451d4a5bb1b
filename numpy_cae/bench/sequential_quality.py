"""Training of `SequentialAutoencoder`, here and in PyTorch, for `quality`.

All start from the same weights and learn from clips that they draw from the same motions.
"""

from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.bench.convolutional import torch
from numpy_cae.bench.quality import Training
from numpy_cae.bench.sequential import SequenceCase, TorchSequenceModel
from numpy_cae.fast import accelerate
from numpy_cae.manifold.learning import BURN_IN, HIDDEN, LATENT
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import SequenceSchedule, unit_directions
from numpy_cae.training.adam import BETA_2
from numpy_cae.training.schedule import rate_at
from numpy_cae.training.step import make_optimiser, sequence_step

USUAL = SequenceSchedule(rate=0.001)
"""PyTorch with Adam and `OneCycleLR` as they come, and the batch of the recipe paper."""

Draw = Callable[[np.random.Generator, int], np.ndarray]


def trainings(
    draw: Draw, held_out: np.ndarray, schedule: SequenceSchedule, seed: int = 0
) -> list[Training]:
    """Ours by `schedule`, PyTorch's by `USUAL` and by `schedule`.

    `draw` is as in `train_sequential`; the mean squared error is that of `held_out`, normalised
    clips (N, T, features).
    """
    rng = np.random.default_rng(seed)
    sizes = held_out.shape[2], HIDDEN, LATENT
    model = accelerate(SequentialAutoencoder(*sizes, rng, burn_in=BURN_IN))
    usual, same = TorchSequenceModel(model), TorchSequenceModel(model)

    def measured(denoise: Callable[[np.ndarray], np.ndarray]) -> Callable[[], float]:
        return lambda: float(np.mean((denoise(held_out) - held_out) ** 2, dtype=np.float64))

    by_ours = torch_epochs(same, draw, schedule, BETA_2)
    rows = (
        ("numpy_cae", schedule, epochs(model, draw, schedule), model.denoise),
        ("PyTorch, usual settings", USUAL, torch_epochs(usual, draw, USUAL), usual.denoise),
        ("PyTorch, our settings", schedule, by_ours, same.denoise),
    )
    return [Training(name, by.epochs, turns, measured(f)) for name, by, turns, f in rows]


def epochs(
    model: SequentialAutoencoder, draw: Draw, schedule: SequenceSchedule, seed: int = 0
) -> Iterator[None]:
    """Train for an epoch at each `next`, as `numpy-cae train` does."""
    rng = np.random.default_rng(seed)
    optimiser = make_optimiser(schedule, model.weights)
    for epoch in range(schedule.epochs):
        for step in range(schedule.steps):
            rate = rate_at(schedule, epoch, step, schedule.steps)
            sequence_step(model, draw(rng, schedule.batch), schedule, rate, rng, optimiser)
        yield


def torch_epochs(
    model: TorchSequenceModel,
    draw: Draw,
    schedule: SequenceSchedule,
    beta_2: float = 0.999,
    seed: int = 0,
) -> Iterator[None]:
    """The same in PyTorch."""
    rng, sizes = np.random.default_rng(seed), (schedule.batch, LATENT)
    optimiser = torch.optim.Adam(model.parameters, betas=(0.9, beta_2), fused=True)
    steps = schedule.epochs * schedule.steps
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, schedule.rate, steps)
    for _ in range(schedule.epochs):
        for _ in range(schedule.steps):
            prior = rng.standard_normal(sizes, dtype=np.float32)
            directions = unit_directions(schedule.directions, LATENT, rng)
            case = SequenceCase(draw(rng, schedule.batch), prior, directions)
            model.function(case, schedule.weight)()
            torch.nn.utils.clip_grad_norm_(model.parameters, schedule.norm)
            optimiser.step()
            rates.step()
        yield
