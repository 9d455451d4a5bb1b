"""The times that trainings need to one error: numpy_cae, and the same networks in PyTorch.

The trainings run one after the other in one process; only the training is timed, not the
measurements of its error.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from numpy_cae import training
from numpy_cae.evaluation.tables import Clips
from numpy_cae.fast import accelerate
from numpy_cae.manifold import learn_manifold
from numpy_cae.manifold.completion import zeroed_fraction
from numpy_cae.manifold.learning import BURN_IN, HIDDEN, LATENT, mean_and_deviation
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.motion import cut_clips, cut_windows, draw_clips
from numpy_cae.training.optimisers import BETA_2
from numpy_cae.training.sequential import Draw
from studies.jang2018.actions import synthetic_action
from studies.shared.material import Material, testing_of
from studies.shared.messages import note
from studies.shared.result import Table
from studies.timing.torch_networks import TorchModel, TorchSequences, torch, windows

USUAL = training.Stage(epochs=50, rate=0.001, batch=16, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True)
"""PyTorch with the usual settings: Adam's and `OneCycleLR`'s own, no bound on the norm. The batch,
the peak rate and the epochs are those that need the least time
(docs/lab_book/end_to_end.md)."""
USUAL_SEQUENCES = training.SequenceSchedule(rate=0.001)
"""The same, with the batch, the epochs and the bound on the norm of the recipe paper."""
USUAL_BETA_2 = 0.999
MINUTES = 60.0
"""Minutes of synthetic walking to train on, and as many of other people to hold out."""
HELD_OUT_STEP = 600
"""Held-out clips start this many frames apart."""
NONE = training.Stage(epochs=0)
Curve = list[tuple[float, float]]
"""The seconds of training, and the held-out error, after each epoch."""
AfterEpoch = Callable[[], None]
Training = tuple[Any, Callable[[AfterEpoch], object]]
"""A network, and a function that trains it and calls another after each epoch."""


def time_to_quality(material: Material, seed: int = 0) -> Table:
    """Train by recipe fast here, and in PyTorch by `USUAL` and by recipe fast, from equal weights.

    The error is that of the table of `numpy-cae train`: half of the values of the test takes
    removed. ValueError where PyTorch is not installed.
    """
    schedule = training.recipe("fast")
    x, testing = _windows(material, schedule.rms)
    damaged = training.zero_values(testing.x, 0.5, np.random.default_rng(seed))
    given = damaged / (1 - zeroed_fraction(damaged))
    model = accelerate(ConvAutoencoder(rng=np.random.default_rng(seed), initial=schedule.initial))
    fine_tuning = training.Schedule(NONE, schedule.fine_tuning)

    def train(after_epoch: AfterEpoch) -> None:
        training.train_autoencoder(model, x, fine_tuning, seed, _epoch_report(after_epoch))

    def in_torch(stage: training.Stage, beta_2: float) -> Training:
        network = TorchModel(model)
        return network, partial(train_in_torch, network, x, stage, beta_2)

    def error(network: Any) -> float:
        return testing.error(network.project(given))

    settings = USUAL, schedule.fine_tuning
    return _quality_of((model, train), in_torch, settings, error, "cm", seed)


def sequences_to_quality(seed: int = 0) -> Table:
    """The same of the sequential network on synthetic walking, by its recipe fast and by
    `USUAL_SEQUENCES`. The error is the share of the variance of other people's clips."""
    schedule = training.SEQUENCE_RECIPES["fast"]
    action = synthetic_action("walking", MINUTES)
    mean, deviation = mean_and_deviation(cut_clips(action.training))

    def draw(rng: np.random.Generator, batch: int) -> np.ndarray:
        return _normalised(draw_clips(action.training, batch, rng), mean, deviation)

    held_out = _normalised(cut_clips(action.testing, HELD_OUT_STEP), mean, deviation)
    rng = np.random.default_rng(seed)
    untrained = SequentialAutoencoder(len(mean), HIDDEN, LATENT, rng, burn_in=BURN_IN)
    model = accelerate(untrained)

    def train(after_epoch: AfterEpoch) -> None:
        training.train_sequential(model, draw, schedule, seed, _epoch_report(after_epoch))

    def in_torch(settings: training.SequenceSchedule, beta_2: float) -> Training:
        network = TorchSequences(model)
        return network, partial(train_sequences_in_torch, network, draw, settings, beta_2, seed)

    def error(network: Any) -> float:
        return float(np.mean((network.denoise(held_out) - held_out) ** 2, dtype=np.float64))

    settings = USUAL_SEQUENCES, schedule
    return _quality_of((model, train), in_torch, settings, error, "of the variance", seed)


def _epoch_report(after_epoch: AfterEpoch) -> Callable[[training.TrainingState], None]:
    """A report of a training that calls a function after each epoch."""

    def report(state: training.TrainingState) -> None:
        if state.step == 0:
            after_epoch()

    return report


def _quality_of(
    ours: Training,
    in_torch: Callable[..., Training],
    settings: tuple,
    error: Callable[[Any], float],
    unit: str,
    seed: int,
) -> Table:
    """Our training, and PyTorch's by the usual settings and by ours, one after the other."""
    if torch is None:
        raise ValueError("PyTorch is not installed (package torch)")
    torch.manual_seed(seed)
    usual, same = settings
    trainings = {
        "numpy_cae": ours,
        "PyTorch, usual settings": in_torch(usual, USUAL_BETA_2),
        "PyTorch, our settings": in_torch(same, BETA_2),
    }
    _, warm_up = in_torch(replace(usual, epochs=1), USUAL_BETA_2)
    warm_up(lambda: None)  # the first steps take seconds
    curves = {}
    for name, (network, train) in trainings.items():
        curves[name] = curve(train, partial(error, network))
    return quality(curves, unit)


def _normalised(clips: np.ndarray, mean: np.ndarray, deviation: np.ndarray) -> np.ndarray:
    return ((clips - mean) / deviation).astype(np.float32)


def _windows(material: Material, rms: float) -> tuple[np.ndarray, Clips]:
    """Normalised windows (N, T, 63) to train on, scaled to `rms`, and the windows to test on."""
    takes = [take.positions for take in material.training]
    # For the mean pose, the scale and the mean skeleton; its network is not used.
    frame = learn_manifold(takes, training.Schedule(NONE, NONE, rms=rms), filters=(1,), taps=1)
    cut = [frame.normalise(cut_windows(frame.features(take)[0])[0]) for take in takes]
    return np.concatenate(cut), testing_of(frame, material)[0]


def curve(train: Callable[[AfterEpoch], object], error: Callable[[], float]) -> Curve:
    """Train, and measure the error after each epoch."""
    measured: Curve = []
    seconds = 0.0
    start = time.perf_counter()

    def after_epoch() -> None:
        nonlocal seconds, start
        seconds += time.perf_counter() - start
        measured.append((seconds, error()))
        note(f"epoch {len(measured)}: {seconds:.1f} s, held-out error {measured[-1][1]:.3f}")
        start = time.perf_counter()

    train(after_epoch)
    return measured


def quality(curves: dict[str, Curve], unit: str) -> Table:
    """The seconds of each training to the lowest error that all reach; ours is the first."""
    lowest = {name: min(error for _, error in points) for name, points in curves.items()}
    target = max(lowest.values())
    needed = {name: min(s for s, e in points if e <= target) for name, points in curves.items()}
    first = next(iter(needed.values()))
    rows = [[n, s, s / first, curves[n][-1][0], lowest[n]] for n, s in needed.items()]
    seconds = f"seconds to {target:.3f} {unit}"
    header = ["training", seconds, "ratio", "seconds in all", f"lowest error, {unit}"]
    return Table("", header, rows, ("", ".1f", ".2f", ".1f", ".3f"))


def train_in_torch(
    model: TorchModel,
    x: np.ndarray,
    stage: training.Stage,
    beta_2: float,
    after_epoch: AfterEpoch,
) -> None:
    """Denoising end to end in PyTorch, by Adam and a one-cycle rate."""
    clean = windows(x)
    update = _update(model, stage, -(-len(clean) // stage.batch), beta_2)
    low, high = stage.zeroed
    for _ in range(stage.epochs):
        for chosen in torch.randperm(len(clean)).split(stage.batch):
            batch = clean[chosen]
            p = low + (high - low) * torch.rand(len(batch), 1, 1)
            corrupted = batch * (torch.rand(batch.shape) >= p) / (1 - p)
            update(model.loss(batch, corrupted, [None] * len(model.layers), model.layers))
        after_epoch()


def train_sequences_in_torch(
    model: TorchSequences,
    draw: Draw,
    schedule: training.SequenceSchedule,
    beta_2: float,
    seed: int,
    after_epoch: AfterEpoch,
) -> None:
    """The same of the sequential network."""
    rng = np.random.default_rng(seed)
    update = _update(model, schedule, schedule.steps, beta_2)
    for _ in range(schedule.epochs):
        for _ in range(schedule.steps):
            prior = rng.standard_normal((schedule.batch, LATENT), dtype=np.float32)
            directions = training.unit_directions(schedule.directions, LATENT, rng, np.float32)
            clips = draw(rng, schedule.batch)
            tensors = (torch.tensor(array) for array in (clips, prior, directions))
            update(model.loss(*tensors, schedule.weight))
        after_epoch()


def _update(model: Any, settings: Any, steps: int, beta_2: float) -> Callable[[Any], None]:
    """A step of Adam with a one-cycle rate, from the loss; an epoch has so many."""
    optimiser = torch.optim.Adam(model.parameters, betas=(0.9, beta_2), fused=True)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, settings.rate, settings.epochs * steps)

    def update(loss: Any) -> None:
        optimiser.zero_grad()
        loss.backward()
        if settings.norm is not None:
            torch.nn.utils.clip_grad_norm_(model.parameters, settings.norm)
        optimiser.step()
        rates.step()

    return update
