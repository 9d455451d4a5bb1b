"""Same seed and same number of threads: same weights to the bit, however the work is shared out."""

import numpy as np
import pytest

from numpy_cae.fast import accelerate, fast_conv_autoencoder
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import Schedule, Stage, train_autoencoder


def trained_weights(threads, batch):
    """All weights after two epochs of every stage, by so many threads."""
    rng = np.random.default_rng(0)
    model = ConvAutoencoder(9, (16, 24), taps=15, rng=rng)
    model = accelerate(model, threads)
    windows = (0.25 * rng.normal(size=(20, 40, 9))).astype(np.float32)
    schedule = Schedule(Stage(epochs=2, batch=batch), Stage(2, 0.01, 0.9, 0.0, batch))
    train_autoencoder(model, windows, schedule, rng, show_progress=False)
    return [array for layer in model.layers for array in (layer.w, layer.b)]


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("batch", [1, 12])
def test_two_runs_are_equal_to_the_bit(monkeypatch, threads, batch):
    monkeypatch.setattr(fast_conv_autoencoder, "MIN_MULTIPLICATIONS", 0)
    one, two = (trained_weights(threads, batch) for _ in range(2))
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a, b)


def test_another_number_of_threads_changes_no_more_than_rounding(monkeypatch):
    monkeypatch.setattr(fast_conv_autoencoder, "MIN_MULTIPLICATIONS", 0)
    for a, b in zip(trained_weights(1, 12), trained_weights(2, 12), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-4)
