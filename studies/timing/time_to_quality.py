"""The times that trainings need to one error: numpy_cae, and the same network in PyTorch.

The trainings run one after the other in one process; only the training is timed, not the
measurements of its error.
"""

import time
from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.cli.shared.output import note
from numpy_cae.evaluation.clips import Clips
from numpy_cae.fast import accelerate
from numpy_cae.manifold import learn_manifold
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import cut_windows
from numpy_cae.training import Schedule, Stage, TrainingState, recipe, zero_values
from numpy_cae.training.adam import BETA_2
from numpy_cae.training.layerwise import autoencoder_steps
from studies.shared.clips import testing_of
from studies.shared.material import Material
from studies.shared.result import Table
from studies.timing.torch_convolutional import TorchModel, torch, windows

USUAL = Stage(epochs=50, rate=0.001, batch=16, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True)
"""PyTorch with the usual settings: Adam's and `OneCycleLR`'s own, no bound on the norm. The batch,
the peak rate and the epochs are those that need the least time
(docs/lab_book/end_to_end.md)."""
USUAL_BETA_2 = 0.999
NONE = Stage(epochs=0)
Curve = list[tuple[float, float]]
"""The seconds of training, and the held-out error in cm, after each epoch."""


def time_to_quality(material: Material, seed: int = 0) -> Table:
    """Train by recipe fast here, and in PyTorch by `USUAL` and by recipe fast, from equal weights.

    The error is that of the table of `numpy-cae train`: half of the values of the test takes
    removed. ValueError where PyTorch is not installed.
    """
    if torch is None:
        raise ValueError("PyTorch is not installed (package torch)")
    torch.manual_seed(seed)
    schedule = recipe("fast")
    x, testing = _windows(material, schedule.rms)
    damaged = zero_values(testing.x, 0.5, np.random.default_rng(seed))
    given = damaged / (1 - zeroed_fraction(damaged))
    model = accelerate(ConvAutoencoder(rng=np.random.default_rng(seed), initial=schedule.initial))
    settings = {"usual": (USUAL, USUAL_BETA_2), "our": (schedule.fine_tuning, BETA_2)}
    theirs = {name: TorchModel(model) for name in settings}
    next(torch_epochs(TorchModel(model), x[: USUAL.batch], USUAL, USUAL_BETA_2))  # takes seconds
    state = TrainingState(model.parameters, np.random.default_rng(seed))
    steps = autoencoder_steps(model, x, Schedule(NONE, schedule.fine_tuning), state)
    epochs = (None for _ in steps if state.step == 0)
    curves = {"numpy_cae": curve(epochs, lambda: testing.error(model.project(given)))}
    for name, network in theirs.items():
        epochs = torch_epochs(network, x, *settings[name])
        measured = curve(epochs, lambda net=network: testing.error(net.project(given)))
        curves[f"PyTorch, {name} settings"] = measured
    return quality(curves)


def _windows(material: Material, rms: float) -> tuple[np.ndarray, Clips]:
    """Normalised windows (N, T, 63) to train on, scaled to `rms`, and the windows to test on."""
    takes = [take.positions for take in material.training]
    # For the mean pose, the scale and the mean skeleton; its network is not used.
    frame = learn_manifold(takes, Schedule(NONE, NONE, rms=rms), filters=(1,), taps=1)
    cut = [frame.normalise(cut_windows(frame.features(take)[0])[0]) for take in takes]
    return np.concatenate(cut), testing_of(frame, material)[0]


def curve(epochs: Iterator[None], error: Callable[[], float]) -> Curve:
    """Train for one epoch at each `next`, and measure the error after each."""
    measured: Curve = []
    seconds, start = 0.0, time.perf_counter()
    for _ in epochs:
        seconds += time.perf_counter() - start
        measured.append((seconds, error()))
        note(f"epoch {len(measured)}: {seconds:.1f} s, held-out error {measured[-1][1]:.3f} cm")
        start = time.perf_counter()
    return measured


def quality(curves: dict[str, Curve]) -> Table:
    """The seconds of each training to the lowest error that all reach; ours is the first."""
    lowest = {name: min(error for _, error in each) for name, each in curves.items()}
    target = max(lowest.values())
    needed = {name: min(s for s, e in each if e <= target) for name, each in curves.items()}
    first = next(iter(needed.values()))
    rows = [[n, s, s / first, curves[n][-1][0], lowest[n]] for n, s in needed.items()]
    seconds = f"seconds to {target:.3f} cm"
    header = ["training", seconds, "ratio", "seconds in all", "lowest error, cm"]
    return Table("", header, rows, ("", ".1f", ".2f", ".1f", ".3f"))


def torch_epochs(model: TorchModel, x: np.ndarray, stage: Stage, beta_2: float) -> Iterator[None]:
    """Denoising end to end in PyTorch, an epoch at each `next`, by Adam and a one-cycle rate."""
    every = windows(x)
    optimiser = torch.optim.Adam(model.parameters, betas=(0.9, beta_2), fused=True)
    steps = stage.epochs * -(-len(every) // stage.batch)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, stage.rate, steps)
    low, high = stage.zeroed
    for _ in range(stage.epochs):
        for chosen in torch.randperm(len(every)).split(stage.batch):
            batch = every[chosen]
            p = low + (high - low) * torch.rand(len(batch), 1, 1)
            corrupted = batch * (torch.rand(batch.shape) >= p) / (1 - p)
            optimiser.zero_grad()
            model.loss(batch, corrupted, [None] * len(model.layers), model.layers).backward()
            if stage.norm is not None:
                torch.nn.utils.clip_grad_norm_(model.parameters, stage.norm)
            optimiser.step()
            rates.step()
        yield
