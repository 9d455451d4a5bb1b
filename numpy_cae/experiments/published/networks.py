"""Both papers' networks on the protocol's 59 columns.

The hidden part starts as the prediction of kernel ridge regression. A network is trained to turn
rows with such a start (predicted for each take by a regression on other takes) into true rows, and
so corrects the start. The convolutional network is averaged over all shifts of its pooling grid,
the sequential one over all clips that contain a row.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.experiments.published.baselines import add_offset, kernel_ridge
from numpy_cae.experiments.published.protocol import FOLDS, GROUPS, Fill, Method
from numpy_cae.fast import accelerate
from numpy_cae.manifold.shifted_projection import project_shifted
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import Adam, SequenceSchedule, clip_norm, one_cycle, train_sequential

START = {"leg": (7, 4.0, 0.1), "body": (7, 8.0, 0.3)}
"""Settings of `kernel_ridge`, chosen by leaving takes out, as is everything below."""
VISIBLE, HIDDEN = 0.15, 0.4
"""Factors of the standardised columns, so that the loss is mostly that of the hidden ones."""
FILTERS, TAPS, WINDOW = (128,), 15, 32
STEPS, BATCH, RATE, NORM = 800, 16, 2e-3, 0.05
NOISE = 0.1
"""Deviation of what is added to the standardised input."""
UNITS, LATENT, CLIP, CLIPS = 128, 32, 16, 32
SEQUENCE = SequenceSchedule(
    1, 800, 3e-3, batch=CLIPS, weight=0.01, optimiser="adam", rate_schedule="one-cycle"
)


Project = Callable[[np.ndarray], np.ndarray]
"""A take (F, 59), multiplied by its factors, to the network's output."""


def start(columns: list[int]) -> Method:
    """The method that predicts the start for these columns."""
    group = next(name for name, own in GROUPS.items() if own == columns)
    return kernel_ridge(*START[group])


def convolutional(seed: int) -> Method:
    """`ConvAutoencoder`, trained from a seed."""

    def learn(takes: Sequence[np.ndarray], columns: list[int]) -> Fill:
        rng = np.random.default_rng(seed)
        factors = _factors(columns)
        network = accelerate(ConvAutoencoder(59, FILTERS, TAPS, rng=rng), 1)
        edge = TAPS // 2
        clean = [_padded(take * factors, edge, WINDOW) for take in takes]
        started = [_padded(take * factors, edge, WINDOW) for take in _started(takes, columns)]
        optimiser = Adam(network.parameters)
        for step in range(STEPS):
            x, corrupted = _draw(clean, started, rng)
            noise = rng.standard_normal(x.shape, dtype=np.float32)
            _, gradients = network.loss_and_gradients(x, corrupted + NOISE * factors * noise)
            flat = [gradient for layer in gradients for gradient in layer]
            clip_norm(flat, NORM)
            optimiser.update(flat, one_cycle(RATE, step / STEPS))

        def project(x: np.ndarray) -> np.ndarray:
            padded = _padded(x, WINDOW, WINDOW + len(x) % 2)[None]
            shifts = network.frames_per_unit
            return project_shifted(network, padded, shifts)[0, WINDOW : WINDOW + len(x)]

        return _corrected(takes, columns, project)

    return learn


def sequential(seed: int) -> Method:
    """`SequentialAutoencoder`, trained from a seed on undamaged clips."""

    def learn(takes: Sequence[np.ndarray], columns: list[int]) -> Fill:
        rng = np.random.default_rng(seed)
        factors = _factors(columns) / HIDDEN
        model = SequentialAutoencoder(59, UNITS, LATENT, rng)
        network = accelerate(model, 1)
        clips = np.concatenate([_clips((take * factors).astype(np.float32)) for take in takes])

        def draw(rng: np.random.Generator, batch: int) -> np.ndarray:
            return clips[rng.integers(len(clips), size=batch)]

        train_sequential(network, draw, SEQUENCE, rng, False)

        def denoise(x: np.ndarray) -> np.ndarray:
            written = network.denoise(_clips((x / HIDDEN).astype(np.float32)))
            total, count = np.zeros(x.shape), np.zeros((len(x), 1))
            for first, clip in enumerate(written):
                total[first : first + CLIP] += clip
                count[first : first + CLIP] += 1
            return total / count * HIDDEN

        return _corrected(takes, columns, denoise)

    return learn


def _corrected(takes: Sequence[np.ndarray], columns: list[int], network: Project) -> Fill:
    """Start, denoise, then add the take's offset.

    The columns count as hidden in all rows; the rows before the hole show the network's error.
    """
    fill_start, factors = start(columns)(takes, columns), _factors(columns)

    def fill(take: np.ndarray, first: int) -> np.ndarray:
        whole = take.copy()
        whole[:, columns] = fill_start(take, first)
        return (network(whole * factors) / factors)[:, columns]

    return add_offset(fill, columns)


def _started(takes: Sequence[np.ndarray], columns: list[int]) -> list[np.ndarray]:
    """The takes with the columns as predicted by a regression on other takes."""
    started = [take.copy() for take in takes]
    for fold in range(FOLDS):
        others = [take for n, take in enumerate(takes) if n % FOLDS != fold]
        fill = start(columns)(others, columns)
        for take in started[fold::FOLDS]:
            take[:, columns] = fill(take, 0)
    return started


def _draw(
    clean: list[np.ndarray], started: list[np.ndarray], rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Windows of takes, and the same with the start in all rows or, in half of them, from a random
    row on."""
    counts = np.array([len(take) - WINDOW + 1 for take in clean])
    x = np.empty((BATCH, WINDOW, clean[0].shape[1]), np.float32)
    corrupted = np.empty_like(x)
    for window, number in enumerate(rng.choice(len(clean), BATCH, p=counts / counts.sum())):
        begin = rng.integers(counts[number])
        rows = slice(begin, begin + WINDOW)
        first = rng.integers(WINDOW) if rng.random() < 0.5 else 0
        x[window] = corrupted[window] = clean[number][rows]
        corrupted[window, first:] = started[number][rows][first:]
    return x, corrupted


def _factors(columns: list[int]) -> np.ndarray:
    factors = np.full(59, VISIBLE, np.float32)
    factors[columns] = HIDDEN
    return factors


def _padded(take: np.ndarray, before: int, after: int) -> np.ndarray:
    """The end rows repeated."""
    return np.pad(take, ((before, after), (0, 0)), mode="edge").astype(np.float32)


def _clips(take: np.ndarray) -> np.ndarray:
    """The clips from every row on, (F - CLIP + 1, CLIP, C)."""
    return sliding_window_view(take, CLIP, axis=0).swapaxes(1, 2)
