"""End-to-end denoising of `ConvAutoencoder`, here and in PyTorch, for `quality`.

Both start from the same weights and learn from the same windows, in an order and with a corruption
of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.bench.convolutional import TorchModel, torch
from numpy_cae.bench.quality import Training
from numpy_cae.fast import accelerate
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import Stage
from numpy_cae.training.schedule import rate_at
from numpy_cae.training.step import denoising_step, make_optimiser

THEIRS = Stage(60, 0.001, batch=16, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True)
"""PyTorch's training: of Adam with `OneCycleLR` and their default settings the batch, the peak rate
and the epochs that need the least time (docs/lab_book.md)."""

Repair = Callable[[np.ndarray], np.ndarray]


def trainings(
    windows: np.ndarray, stage: Stage, error: Callable[[Repair], float], seed: int = 0
) -> tuple[Training, Training]:
    """Ours by `stage` and PyTorch's by `THEIRS`, on normalised windows (N, T, 63).

    `error` measures a function that repairs normalised windows, in cm.
    """
    torch.manual_seed(seed)
    model = accelerate(ConvAutoencoder(rng=np.random.default_rng(seed)))
    theirs = TorchModel(model)

    def measured(project: Repair) -> Callable[[], float]:
        return lambda: error(lambda x: project(x / (1 - zeroed_fraction(x))))

    return (
        Training("numpy_cae", stage.epochs, epochs(model, windows, stage), measured(model.project)),
        Training("PyTorch", THEIRS.epochs, torch_epochs(theirs, windows), measured(theirs.project)),
    )


def epochs(
    model: ConvAutoencoder, windows: np.ndarray, stage: Stage, seed: int = 0
) -> Iterator[None]:
    """Train for an epoch at each `next`, as `numpy-cae train` does."""
    rng = np.random.default_rng(seed)
    optimiser = make_optimiser(stage, model.parameters)
    steps = -(-len(windows) // stage.batch)
    for epoch in range(stage.epochs):
        order = rng.permutation(len(windows))
        for step in range(steps):
            x = windows[order[step * stage.batch : (step + 1) * stage.batch]]
            denoising_step(model, x, stage, rate_at(stage, epoch, step, steps), rng, optimiser)
        yield


def torch_epochs(model: TorchModel, windows: np.ndarray) -> Iterator[None]:
    """The same in PyTorch, by `THEIRS`."""
    windows = torch.tensor(np.ascontiguousarray(windows.transpose(0, 2, 1)))
    parameters = [parameter for w, b, _ in model.layers for parameter in (w, b)]
    optimiser = torch.optim.Adam(parameters, fused=True)
    steps = -(-len(windows) // THEIRS.batch)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, THEIRS.rate, THEIRS.epochs * steps)
    (low, high), whole = THEIRS.zeroed, [None] * len(model.layers)
    for _ in range(THEIRS.epochs):
        for chosen in torch.randperm(len(windows)).split(THEIRS.batch):
            x = windows[chosen]
            p = low + (high - low) * torch.rand(len(x), 1, 1)
            corrupted = x * (torch.rand(x.shape) >= p) / (1 - p)
            optimiser.zero_grad()
            y = model.encode(corrupted, model.layers)
            loss = ((model.decode(y, model.layers, whole) - x) ** 2).mean()
            loss.backward()
            optimiser.step()
            rates.step()
        yield
