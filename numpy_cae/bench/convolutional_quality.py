"""End-to-end denoising of `ConvAutoencoder`, here and in PyTorch, from the same first weights."""

from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.bench.convolutional import TorchModel, torch
from numpy_cae.bench.quality import Training
from numpy_cae.fast import accelerate
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import Stage
from numpy_cae.training.adam import BETA_2
from numpy_cae.training.schedule import rate_at
from numpy_cae.training.step import denoising_step, make_optimiser

USUAL = Stage(50, 0.001, batch=16, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True)
"""PyTorch with the usual settings: Adam's and `OneCycleLR`'s own, no bound on the norm. The batch,
the peak rate and the epochs are those that need the least time (docs/lab_book.md)."""

Repair = Callable[[np.ndarray], np.ndarray]


def trainings(
    windows: np.ndarray, stage: Stage, error: Callable[[Repair], float], seed: int = 0
) -> list[Training]:
    """Ours by `stage`, PyTorch's by `USUAL` and by `stage`, on normalised windows (N, T, 63).

    `error` measures a function that repairs normalised windows, in cm.
    """
    torch.manual_seed(seed)
    model = accelerate(ConvAutoencoder(rng=np.random.default_rng(seed)))
    usual, same, first = (TorchModel(model) for _ in range(3))
    next(torch_epochs(first, windows[: USUAL.batch], USUAL))  # the first step takes seconds

    def measured(project: Repair) -> Callable[[], float]:
        return lambda: error(lambda x: project(x / (1 - zeroed_fraction(x))))

    rows = (
        ("numpy_cae", stage, epochs(model, windows, stage), model.project),
        ("PyTorch, usual settings", USUAL, torch_epochs(usual, windows, USUAL), usual.project),
        ("PyTorch, our settings", stage, torch_epochs(same, windows, stage, BETA_2), same.project),
    )
    return [Training(name, by.epochs, turns, measured(f)) for name, by, turns, f in rows]


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


def torch_epochs(
    model: TorchModel, windows: np.ndarray, stage: Stage, beta_2: float = 0.999
) -> Iterator[None]:
    """The same in PyTorch."""
    windows = torch.tensor(np.ascontiguousarray(windows.transpose(0, 2, 1)))
    parameters = [parameter for w, b, _ in model.layers for parameter in (w, b)]
    optimiser = torch.optim.Adam(parameters, betas=(0.9, beta_2), fused=True)
    steps = stage.epochs * -(-len(windows) // stage.batch)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, stage.rate, steps)
    (low, high), whole = stage.zeroed, [None] * len(model.layers)
    for _ in range(stage.epochs):
        for chosen in torch.randperm(len(windows)).split(stage.batch):
            x = windows[chosen]
            p = low + (high - low) * torch.rand(len(x), 1, 1)
            corrupted = x * (torch.rand(x.shape) >= p) / (1 - p)
            optimiser.zero_grad()
            y = model.encode(corrupted, model.layers)
            loss = ((model.decode(y, model.layers, whole) - x) ** 2).mean()
            loss.backward()
            if stage.norm is not None:
                torch.nn.utils.clip_grad_norm_(parameters, stage.norm)
            optimiser.step()
            rates.step()
        yield
