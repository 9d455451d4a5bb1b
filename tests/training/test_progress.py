"""What training prints: progress, and where it diverged."""

from types import SimpleNamespace

import numpy as np
import pytest

from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import DivergedError, Schedule, Stage, layerwise, train_autoencoder
from numpy_cae.training import progress as module
from numpy_cae.training.loop import Position
from numpy_cae.training.progress import Progress

SCHEDULE = Schedule(Stage(epochs=2, batch=5), Stage(3, 0.01, batch=5))
WINDOWS = np.random.default_rng(0).normal(scale=0.3, size=(12, 8, 3)).astype(np.float32)


def model():
    return ConvAutoencoder(3, (4, 5), taps=3, rng=np.random.default_rng(0))


def test_a_line_for_each_epoch_or_silence(capsys):
    history = train_autoencoder(model(), WINDOWS, SCHEDULE)
    lines = capsys.readouterr().err.splitlines()
    expected = [
        f"{name}, epoch {number}/{len(losses)}: loss {loss:.5f}, "
        for name, losses in history.losses.items()
        for number, loss in enumerate(losses, start=1)
    ]
    assert len(lines) == len(expected) == 7
    assert all(line.startswith(start) for line, start in zip(lines, expected, strict=True))
    train_autoencoder(model(), WINDOWS, SCHEDULE, show_progress=False)
    assert capsys.readouterr().err == ""


def test_a_line_tells_the_time_that_is_left_and_one_within_an_epoch_comes_rarely(
    monkeypatch, capsys
):
    clock = SimpleNamespace(monotonic=lambda: clock.now, now=100.0)
    monkeypatch.setattr(module, "time", clock)
    task = SimpleNamespace(name="layer 1", stage=Stage(epochs=4))
    loop = SimpleNamespace(task=task, steps=8, position=Position(epoch=1, step=4, seconds=60.0))
    progress = Progress()
    clock.now += 29
    progress.after_step(loop)
    assert capsys.readouterr().err == ""
    clock.now += 2
    progress.after_step(loop)
    progress.after_step(loop)
    assert capsys.readouterr().err == "layer 1, epoch 1.50/4, 60 s elapsed, 100 s left\n"
    loop.position = Position(epoch=2, seconds=70.0)
    progress.after_epoch(loop, 0.125)
    said = "layer 1, epoch 2/4: loss 0.12500, 70 s elapsed, 70 s left\n"
    assert capsys.readouterr().err == said


def test_a_loss_that_is_not_finite_changes_no_weight():
    network, windows = model(), np.full((2, 8, 3), np.nan, np.float32)
    before = [array.copy() for layer in network.layers for array in (layer.w, layer.b)]
    with pytest.raises(DivergedError, match=r"first in the input, windows [12];"):
        train_autoencoder(network, windows, show_progress=False)
    after = [array for layer in network.layers for array in (layer.w, layer.b)]
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))


def test_the_loss_of_an_epoch_is_the_mean_over_its_windows(monkeypatch):
    """Batches of 5, 5 and 2: the small one counts for its two windows and no more."""
    losses = iter([1.0, 2.0, 4.0, 3.0, 3.0, 3.0])
    monkeypatch.setattr(layerwise, "denoising_step", lambda *arguments: next(losses))
    network = ConvAutoencoder(3, (4,), taps=3)
    stages = Schedule(Stage(epochs=1, batch=5), Stage(1, batch=5))
    history = train_autoencoder(network, WINDOWS, stages, show_progress=False)
    assert history.losses["layer 1"] == [pytest.approx((5 * 1 + 5 * 2 + 2 * 4) / 12)]
    assert history.losses["fine tuning"] == [pytest.approx(3.0)]
