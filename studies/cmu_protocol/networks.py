"""Both papers' networks on the protocol's 59 columns, trained by denoising (holden2015, section 6).

The corruption has the protocol's shape: a limb's columns are replaced over many rows. The
replacement is not zero, but the prediction of a Gaussian process from the other columns, learned
from other takes. So filling in starts with that prediction, and the network corrects it. The output
of the convolutional network is averaged over all shifts of the pooling grid, that of the sequential
network over all clips that contain a row.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae import ops
from numpy_cae.fast import accelerate
from numpy_cae.manifold.shifted_projection import project_shifted
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import Adam, Stage, clip_norm, unit_directions
from numpy_cae.training.schedule import learning_rates, one_cycle
from numpy_cae.training.step import denoising_step, make_optimiser
from studies.cmu_protocol.baselines import add_residual, ridge
from studies.cmu_protocol.protocol import FOLDS, GROUPS, Fill, Learn, Method

START = {"leg": (7, 0.1, 4.0), "body": (7, 0.3, 8.0)}
"""Settings of `ridge`. They and all constants below were chosen on training takes left out."""
VISIBLE, HIDDEN = 0.05, 0.4
"""Factors of the standardised columns, so that the loss is mostly that of the hidden ones."""
NOISE = 0.3
"""Standard deviation of the noise that is added to the standardised input."""
BATCH = 16
FILTERS, TAPS, WINDOW, STEPS = (128,), 15, 32, 500
STAGE = Stage(
    epochs=1, rate=2e-3, alpha=0.0, norm=0.05, optimiser="adam", rate_schedule="one-cycle"
)
UNITS, LATENT, CLIP, SEQUENCE_STEPS, SEQUENCE_RATE = 96, 32, 8, 600, 3e-3
WEIGHT, DIRECTIONS = 0.001, 32
"""λ of the sliced Wasserstein distance, and its directions."""

Draw = Callable[[np.random.Generator, int], tuple[np.ndarray, np.ndarray]]
"""Random numbers and a number of rows to a batch of true windows and the corrupted windows."""
Project = Callable[[np.ndarray], np.ndarray]
"""A take (F, 59), multiplied by the factors of its columns, to the network's output."""
Train = Callable[[Draw, int], Project]
"""Batches and a seed to a trained network."""


def networks_of(trainings: Sequence[tuple[Train, int]]) -> Learn:
    """A `Learn` that trains one network for each pair of a training and a seed.

    A training is `convolutional` or `sequential`. When filling in, the columns are hidden in all
    rows, so that `add_residual` can measure the network's error in the rows before the hole.
    """

    def learn(takes: Sequence[np.ndarray], columns: list[int]) -> list[Fill]:
        factors = np.full(59, VISIBLE, np.float32)
        factors[columns] = HIDDEN
        started = _started(takes, columns)
        padded = [_padded(take * factors, WINDOW // 4) for take in takes]
        padded_starts = [_padded(take * factors, WINDOW // 4) for take in started]

        def draw(rng: np.random.Generator, length: int) -> tuple[np.ndarray, np.ndarray]:
            x, corrupted = _windows(padded, padded_starts, length, rng)
            noise = rng.standard_normal(x.shape, dtype=np.float32)
            return x, corrupted + NOISE * factors * noise

        def fill_with(project: Project) -> Fill:
            def fill(take: np.ndarray, first: int) -> np.ndarray:
                whole = take.copy()
                whole[:, columns] = fill_start(take, first)
                return (project(whole * factors) / factors)[:, columns]

            return add_residual(fill, columns)

        fill_start = start(columns)(takes, columns)
        return [fill_with(train(draw, seed)) for train, seed in trainings]

    return learn


def ensemble(fills: Sequence[Fill]) -> Fill:
    """The mean of what several networks fill in."""
    return lambda take, first: np.mean([fill(take, first) for fill in fills], axis=0)


def start(columns: list[int]) -> Method:
    """The method that predicts these columns before the network corrects the prediction."""
    group = next(name for name, hidden in GROUPS.items() if hidden == columns)
    return ridge(*START[group])


def convolutional(draw: Draw, seed: int) -> Project:
    """Train a `ConvAutoencoder`."""
    rng = np.random.default_rng(seed)
    network = accelerate(ConvAutoencoder(59, FILTERS, TAPS, rng=rng), 1)
    optimiser, stride = make_optimiser(STAGE, network.parameters), network.stride
    rates = learning_rates(STAGE, STEPS)
    for step in range(STEPS):
        x, corrupted = draw(rng, WINDOW)
        denoising_step(network, x, corrupted, None, STAGE, rates[step], optimiser)

    def project(take: np.ndarray) -> np.ndarray:
        padded = _padded(take, WINDOW)
        padded = padded[: len(padded) // stride * stride]
        projected = project_shifted(network, padded[None], average_shifts=True)[0]
        return projected[WINDOW : WINDOW + len(take)]

    return project


def sequential(draw: Draw, seed: int) -> Project:
    """Train a `SequentialAutoencoder`.

    jang2018 trains it to reproduce its own input; here the input is corrupted. The engine of `fast`
    computes the loss of jang2018 only, so the gradients are those of the definitions.
    """
    rng = np.random.default_rng(seed)
    network = SequentialAutoencoder(59, UNITS, LATENT, rng)
    optimiser = Adam(network.weights)
    for step in range(SEQUENCE_STEPS):
        x, corrupted = draw(rng, CLIP)
        z, encoder_pullback = network.encode_with_pullback(corrupted)
        x_hat, decoder_pullback = network.decode_with_pullback(z, CLIP)
        _, error_pullback = ops.mean_squared_error(x_hat, x)
        prior = rng.standard_normal(z.shape, dtype=np.float32)
        directions = unit_directions(DIRECTIONS, LATENT, rng)
        _, prior_pullback = ops.sliced_wasserstein(z, prior, directions)
        dz, of_decoder = decoder_pullback(error_pullback())
        gradients = encoder_pullback(dz + prior_pullback(WEIGHT)) | of_decoder
        flat = [gradients[name] for name in network.weights]
        clip_norm(flat, 1.0)
        optimiser.update(flat, one_cycle(SEQUENCE_RATE, step / SEQUENCE_STEPS))
    fast = accelerate(network, 1)

    def project(take: np.ndarray) -> np.ndarray:
        padded = _padded(take, CLIP)
        total, count = np.zeros(padded.shape), np.zeros((len(padded), 1))
        clips = sliding_window_view(padded, CLIP, axis=0).swapaxes(1, 2)
        for first, clip in enumerate(fast.denoise(clips)):
            total[first : first + CLIP] += clip
            count[first : first + CLIP] += 1
        return (total / count)[CLIP : CLIP + len(take)]

    return project


def _started(takes: Sequence[np.ndarray], columns: list[int]) -> list[np.ndarray]:
    """The takes with the columns replaced by predictions of a regression on other takes."""
    started = [take.copy() for take in takes]
    for fold in range(FOLDS):
        others = [take for n, take in enumerate(takes) if n % FOLDS != fold]
        fill = start(columns)(others, columns)
        for take in started[fold::FOLDS]:
            take[:, columns] = fill(take, 0)
    return started


def _windows(
    takes: list[np.ndarray], started: list[np.ndarray], length: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Windows of random takes, and the same windows corrupted.

    Half of the windows have predicted columns in all rows, the other half from a random row on.
    """
    counts = np.array([len(take) - length + 1 for take in takes])
    x = np.empty((BATCH, length, takes[0].shape[1]), np.float32)
    corrupted = np.empty_like(x)
    for window, number in enumerate(rng.choice(len(takes), BATCH, p=counts / counts.sum())):
        begin = rng.integers(counts[number])
        rows = slice(begin, begin + length)
        first = rng.integers(length) if rng.random() < 0.5 else 0
        x[window] = corrupted[window] = takes[number][rows]
        corrupted[window, first:] = started[number][rows][first:]
    return x, corrupted


def _padded(take: np.ndarray, rows: int) -> np.ndarray:
    """Repeat the first and the last row `rows` times."""
    return np.pad(take, ((rows, rows), (0, 0)), mode="edge").astype(np.float32)
