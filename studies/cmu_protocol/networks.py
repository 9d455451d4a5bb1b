"""holden2015's network on the protocol's 59 columns, trained by denoising (section 6).

The corruption has the protocol's shape: a limb's columns are replaced over many rows. The
replacement is not zero, but the prediction of a Gaussian process from the other columns, learned
from other takes. So filling in starts with that prediction, and the network corrects it. Its output
is averaged over all shifts of the pooling grid.
"""

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.manifold.completion import project_shifted
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training.optimisers import Adam, clip_norm
from numpy_cae.training.schedule import one_cycle
from studies.cmu_protocol.protocol import FOLDS, GROUPS, Fill, add_residual, gaussian_process

START = {"leg": (7, 0.1, 4.0), "body": (7, 0.3, 8.0)}
"""Settings of `gaussian_process`. They and all constants below were chosen on training takes that
were left out."""
VISIBLE = 0.05
"""The factor of the standardised columns that are visible."""
HIDDEN = 0.4
"""The factor of those that are hidden, larger, so that the loss is mostly theirs."""
NOISE = 0.3
"""Standard deviation of the noise that is added to the standardised input."""
BATCH = 16
FILTERS = (128,)
TAPS = 15
WINDOW = 32
STEPS = 500
RATE = 2e-3
"""The peak of the learning rate."""
NORM = 0.05
"""The bound on the gradient's norm."""

Draw = Callable[[np.random.Generator], tuple[np.ndarray, np.ndarray]]
"""Random numbers to a batch of true windows and the corrupted windows."""
Project = Callable[[np.ndarray], np.ndarray]
"""A take (F, 59), multiplied by the factors of its columns, to the network's output."""


def networks(takes: Sequence[np.ndarray], columns: list[int], seeds: Sequence[int]) -> list[Fill]:
    """One network for each seed.

    When filling in, the columns are hidden in all rows, so that `add_residual` can measure the
    network's error in the rows before the hole.
    """
    factors = np.full(59, VISIBLE, np.float32)
    factors[columns] = HIDDEN
    padded = [_padded(take * factors, WINDOW // 4) for take in takes]
    predicted = _predict_columns(takes, columns)
    started = [_padded(take * factors, WINDOW // 4) for take in predicted]
    fill_start = start(takes, columns)

    def draw(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        x, corrupted = _windows(padded, started, rng)
        noise = rng.standard_normal(x.shape, dtype=np.float32)
        return x, corrupted + NOISE * factors * noise

    def fill_with(project: Project) -> Fill:
        def fill(take: np.ndarray, first: int) -> np.ndarray:
            filled = take.copy()
            filled[:, columns] = fill_start(take, first)
            return (project(filled * factors) / factors)[:, columns]

        return add_residual(fill, columns)

    return [fill_with(train(draw, seed)) for seed in seeds]


def start(takes: Sequence[np.ndarray], columns: list[int]) -> Fill:
    """The Gaussian process, whose prediction of these columns the network corrects."""
    group = next(name for name, hidden in GROUPS.items() if hidden == columns)
    return gaussian_process(takes, columns, *START[group])


def train(draw: Draw, seed: int) -> Project:
    """Train a `ConvAutoencoder`."""
    rng = np.random.default_rng(seed)
    network = accelerate(ConvAutoencoder(59, FILTERS, TAPS, rng=rng), 1)
    optimiser = Adam(network.parameters)
    for step in range(STEPS):
        _, [gradients] = network.loss_and_gradients(*draw(rng))
        clip_norm(gradients, NORM)
        optimiser.update(gradients, one_cycle(RATE, step / STEPS))

    def project(take: np.ndarray) -> np.ndarray:
        padded = _padded(take, WINDOW)
        padded = padded[: len(padded) // network.stride * network.stride]
        projected = project_shifted(network, padded[None], average_shifts=True)[0]
        return projected[WINDOW : WINDOW + len(take)]

    return project


def _predict_columns(takes: Sequence[np.ndarray], columns: list[int]) -> list[np.ndarray]:
    """The takes with the columns replaced by predictions of a regression on other takes."""
    predicted = [take.copy() for take in takes]
    for fold in range(FOLDS):
        takes_of_other_folds = [take for n, take in enumerate(takes) if n % FOLDS != fold]
        fill = start(takes_of_other_folds, columns)
        for take in predicted[fold::FOLDS]:
            take[:, columns] = fill(take, 0)
    return predicted


def _windows(
    takes: list[np.ndarray], started: list[np.ndarray], rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Windows of random takes, and the same windows corrupted.

    Half of the windows have predicted columns in all rows, the other half from a random row on.
    """
    counts = np.array([len(take) - WINDOW + 1 for take in takes])
    x = np.empty((BATCH, WINDOW, takes[0].shape[1]), np.float32)
    corrupted = np.empty_like(x)
    for window, number in enumerate(rng.choice(len(takes), BATCH, p=counts / counts.sum())):
        begin = rng.integers(counts[number])
        rows = slice(begin, begin + WINDOW)
        first = rng.integers(WINDOW) if rng.random() < 0.5 else 0
        x[window] = corrupted[window] = takes[number][rows]
        corrupted[window, first:] = started[number][rows][first:]
    return x, corrupted


def _padded(take: np.ndarray, rows: int) -> np.ndarray:
    """Repeat the first and the last row `rows` times."""
    return np.pad(take, ((rows, rows), (0, 0)), mode="edge").astype(np.float32)
