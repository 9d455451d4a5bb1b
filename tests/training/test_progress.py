"""What is said of a training: lines of progress, and where it diverged."""

from types import SimpleNamespace

import numpy as np
import pytest

from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import (
    DivergedError,
    ProgressPrinter,
    Schedule,
    Stage,
    TrainingState,
    layerwise,
    train_autoencoder,
)
from numpy_cae.training import progress as module
from numpy_cae.training.progress import require_finite
from numpy_cae.training.sgd import Sgd

SCHEDULE = Schedule(Stage(epochs=2, batch=5), Stage(epochs=3, rate=0.01, batch=5))
WINDOWS = np.random.default_rng(0).normal(scale=0.3, size=(12, 8, 3)).astype(np.float32)


def model():
    return ConvAutoencoder(3, (4, 5), taps=3, rng=np.random.default_rng(0))


def test_a_line_for_each_epoch_or_silence(capsys):
    history = train_autoencoder(model(), WINDOWS, SCHEDULE, report=ProgressPrinter())
    lines = capsys.readouterr().err.splitlines()
    expected = [
        f"{name}, epoch {number}/{len(losses)}: loss {loss:.5f}, "
        for name, losses in history.losses.items()
        for number, loss in enumerate(losses, start=1)
    ]
    assert len(lines) == len(expected) == 7
    assert all(line.startswith(start) for line, start in zip(lines, expected, strict=True))
    train_autoencoder(model(), WINDOWS, SCHEDULE)
    assert capsys.readouterr().err == ""


def test_a_line_has_the_time_that_is_left_and_one_within_an_epoch_comes_rarely(monkeypatch, capsys):
    clock = SimpleNamespace(monotonic=lambda: clock.now, now=100.0)
    monkeypatch.setattr(module, "time", clock)
    state = TrainingState({}, np.random.default_rng(0), name="layer 1", epochs=4, steps=8)
    state.epoch, state.step, state.history.seconds["layer 1"] = 1, 4, 60.0
    printer = ProgressPrinter()
    clock.now += 30
    printer(state)
    assert capsys.readouterr().err == ""
    clock.now += 1
    printer(state)
    printer(state)
    assert capsys.readouterr().err == "layer 1, epoch 1.50/4, 60 s elapsed, 100 s left\n"
    state.epoch, state.step, state.history.seconds["layer 1"] = 2, 0, 70.0
    state.history.losses["layer 1"] = [0.5, 0.125]
    printer(state)
    said = "layer 1, epoch 2/4: loss 0.12500, 70 s elapsed, 70 s left\n"
    assert capsys.readouterr().err == said


def test_a_loss_that_is_not_finite_changes_no_weight():
    network, windows = model(), np.full((2, 8, 3), np.nan, np.float32)
    before = {name: array.copy() for name, array in network.parameters.items()}
    with pytest.raises(DivergedError, match=r"epoch 1, step 1: .* is nan .*finite: the input;"):
        train_autoencoder(network, windows)
    assert all(np.array_equal(a, before[name]) for name, a in network.parameters.items())


@pytest.mark.parametrize(("step", "fails"), [(0, False), (1, True)])
def test_weights_are_checked_at_the_end_of_an_epoch(step, fails):
    state = TrainingState({"w1": np.ones(2), "b1": np.array([np.inf])}, np.random.default_rng(0))
    state.begin_stage("layer 1", Sgd({}), epochs=1, steps=2, examples=2)
    state.step = step
    if fails:
        with pytest.raises(DivergedError, match=r"step 2: .* at rate 0\.5; not finite: b1; there"):
            require_finite(0.1, WINDOWS, 0.5, state, None)
    else:
        require_finite(0.1, WINDOWS, 0.5, state, None)


def test_the_loss_of_an_epoch_is_the_mean_over_its_windows(monkeypatch):
    """Batches of 5, 5 and 2: the small one counts for its two windows and no more."""
    losses = iter([1.0, 2.0, 4.0, 3.0, 3.0, 3.0])
    monkeypatch.setattr(layerwise, "denoising_step", lambda *arguments: next(losses))
    network = ConvAutoencoder(3, (4,), taps=3)
    stages = Schedule(Stage(epochs=1, batch=5), Stage(epochs=1, batch=5))
    history = train_autoencoder(network, WINDOWS, stages)
    assert history.losses["layer 1"] == [pytest.approx((5 * 1 + 5 * 2 + 2 * 4) / 12)]
    assert history.losses["fine tuning"] == [pytest.approx(3.0)]
