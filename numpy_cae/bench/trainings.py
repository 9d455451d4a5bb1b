"""The trainings that `quality` compares: each network here and in PyTorch, from the same first
weights."""

from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.bench.convolutional import TorchModel, torch
from numpy_cae.bench.quality import Training
from numpy_cae.bench.sequential import SequenceCase, TorchSequenceModel
from numpy_cae.fast import accelerate
from numpy_cae.manifold.learning import BURN_IN, HIDDEN, LATENT
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import Schedule, SequenceSchedule, Stage, TrainingState, unit_directions
from numpy_cae.training.adam import BETA_2
from numpy_cae.training.layerwise import autoencoder_steps
from numpy_cae.training.sequential import Draw, sequential_steps

USUAL = Stage(epochs=50, rate=0.001, batch=16, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True)
"""PyTorch with the usual settings: Adam's and `OneCycleLR`'s own, no bound on the norm. The batch,
the peak rate and the epochs are those that need the least time
(docs/lab_book/end_to_end.md)."""
USUAL_SEQUENCES = SequenceSchedule(rate=0.001)
"""The same, with the batch and the bound on the norm of the recipe paper."""
USUAL_BETA_2 = 0.999

Change = Callable[[np.ndarray], np.ndarray]
"""Repairs normalised windows, or denoises normalised clips."""


def trainings(
    windows: np.ndarray, stage: Stage, error: Callable[[Change], float], seed: int = 0
) -> list[Training]:
    """Denoising end to end of normalised windows (N, T, 63): ours by `stage`, PyTorch's by `USUAL`
    and by `stage`. `error` measures a repair, in cm."""
    torch.manual_seed(seed)
    model = accelerate(ConvAutoencoder(rng=np.random.default_rng(seed)))
    usual, same, first = (TorchModel(model) for _ in range(3))
    # The first step takes seconds.
    next(torch_epochs(first, windows[: USUAL.batch], USUAL, USUAL_BETA_2))
    turns = (
        epochs(model, windows, stage),
        torch_epochs(usual, windows, USUAL, USUAL_BETA_2),
        torch_epochs(same, windows, stage, BETA_2),
    )

    def error_of(project: Change) -> float:
        return error(lambda x: project(x / (1 - zeroed_fraction(x))))

    projections = model.project, usual.project, same.project
    return _trainings((stage, USUAL, stage), turns, projections, error_of)


def sequence_trainings(
    draw: Draw, held_out: np.ndarray, schedule: SequenceSchedule, seed: int = 0
) -> list[Training]:
    """The same of clips that `draw` draws: ours by `schedule`, PyTorch's by `USUAL_SEQUENCES` and
    by `schedule`. The mean squared error is that of `held_out`, clips (N, T, features)."""
    rng = np.random.default_rng(seed)
    sizes = held_out.shape[2], HIDDEN, LATENT
    model = accelerate(SequentialAutoencoder(*sizes, rng, burn_in=BURN_IN))
    usual, same = TorchSequenceModel(model), TorchSequenceModel(model)
    turns = (
        sequence_epochs(model, draw, schedule),
        torch_sequence_epochs(usual, draw, USUAL_SEQUENCES, USUAL_BETA_2),
        torch_sequence_epochs(same, draw, schedule, BETA_2),
    )

    def error_of(denoise: Change) -> float:
        return float(np.mean((denoise(held_out) - held_out) ** 2, dtype=np.float64))

    by = schedule, USUAL_SEQUENCES, schedule
    return _trainings(by, turns, (model.denoise, usual.denoise, same.denoise), error_of)


def _trainings(
    by: tuple, turns: tuple, changes: tuple[Change, ...], error_of: Callable[[Change], float]
) -> list[Training]:
    names = "numpy_cae", "PyTorch, usual settings", "PyTorch, our settings"
    return [
        Training(name, stage.epochs, each, lambda change=change: error_of(change))
        for name, stage, each, change in zip(names, by, turns, changes, strict=True)
    ]


def epochs(
    model: ConvAutoencoder, windows: np.ndarray, stage: Stage, seed: int = 0
) -> Iterator[None]:
    """Train for an epoch at each `next`, as `numpy-cae train` does."""
    state = TrainingState(model.parameters, np.random.default_rng(seed))
    schedule = Schedule(layer=Stage(epochs=0), fine_tuning=stage)
    for _ in autoencoder_steps(model, windows, schedule, state):
        if state.step == 0:
            yield


def sequence_epochs(
    model: SequentialAutoencoder, draw: Draw, schedule: SequenceSchedule, seed: int = 0
) -> Iterator[None]:
    """The same for the sequential network."""
    state = TrainingState(model.weights, np.random.default_rng(seed))
    for _ in sequential_steps(model, draw, schedule, state):
        if state.step == 0:
            yield


def torch_epochs(
    model: TorchModel, windows: np.ndarray, stage: Stage, beta_2: float
) -> Iterator[None]:
    """`epochs` in PyTorch."""
    windows = torch.tensor(np.ascontiguousarray(windows.transpose(0, 2, 1)))
    parameters = [parameter for w, b, _ in model.layers for parameter in (w, b)]
    steps = stage.epochs * -(-len(windows) // stage.batch)
    update = _torch_update(parameters, stage, steps, beta_2)
    (low, high), whole = stage.zeroed, [None] * len(model.layers)
    for _ in range(stage.epochs):
        for chosen in torch.randperm(len(windows)).split(stage.batch):
            x = windows[chosen]
            p = low + (high - low) * torch.rand(len(x), 1, 1)
            y = model.encode(x * (torch.rand(x.shape) >= p) / (1 - p), model.layers)
            ((model.decode(y, model.layers, whole) - x) ** 2).mean().backward()
            update()
        yield


def torch_sequence_epochs(
    model: TorchSequenceModel, draw: Draw, schedule: SequenceSchedule, beta_2: float, seed: int = 0
) -> Iterator[None]:
    """`sequence_epochs` in PyTorch."""
    rng, sizes = np.random.default_rng(seed), (schedule.batch, LATENT)
    update = _torch_update(model.parameters, schedule, schedule.epochs * schedule.steps, beta_2)
    for _ in range(schedule.epochs):
        for _ in range(schedule.steps):
            prior = rng.standard_normal(sizes, dtype=np.float32)
            directions = unit_directions(schedule.directions, LATENT, rng)
            case = SequenceCase(draw(rng, schedule.batch), prior, directions)
            model.function(case, schedule.weight)()
            update()
        yield


def _torch_update(
    parameters: list, by: Stage | SequenceSchedule, steps: int, beta_2: float
) -> Callable[[], None]:
    """A function that moves parameters by Adam and a one-cycle rate and clears their gradients."""
    optimiser = torch.optim.Adam(parameters, betas=(0.9, beta_2), fused=True)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, by.rate, steps)

    def update() -> None:
        if by.norm is not None:
            torch.nn.utils.clip_grad_norm_(parameters, by.norm)
        optimiser.step()
        rates.step()
        optimiser.zero_grad()

    return update
