"""Layerwise training: what each stage uses, that it learns, how it steps."""

from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import RECIPES, Schedule, Stage, layerwise, recipe, train_autoencoder
from numpy_cae.training.step import make_optimiser


def waves(windows=12):
    """Mixtures of two sines in five features: easy to reproduce, hard to guess."""
    rng = np.random.default_rng(0)
    time = np.arange(16)[:, None]
    phases = rng.uniform(0, 2 * np.pi, size=(windows, 1, 1))
    mixing = rng.normal(size=(1, 2, 5)) * 0.3
    sines = np.concatenate([np.sin(time / 3 + phases), np.cos(time / 5 + phases)], axis=2)
    return (sines @ mixing).astype(np.float32)


def small_model():
    return ConvAutoencoder(5, (6, 7), taps=5, rng=np.random.default_rng(0))


def trained(**changes):
    schedule = Schedule(
        Stage(epochs=4, **changes), Stage(epochs=4, rate=0.05, alpha=0.0, **changes)
    )
    model = small_model()
    rng = np.random.default_rng(0)
    history = train_autoencoder(model, waves(), schedule, rng)
    return model, history


def test_the_defaults_are_the_papers():
    layer = Stage(
        epochs=25,
        rate=0.5,
        decay=0.9,
        alpha=0.01,
        batch=1,
        zeroed=0.1,
        rescaled=False,
        momentum=0.0,
        norm=None,
        unpooling=None,
        optimiser="sgd",
        rate_schedule="decay",
    )
    assert Schedule() == RECIPES["paper"] == Schedule(layer, replace(layer, rate=0.01, alpha=0.0))
    with pytest.raises(ValueError, match="expected one of paper, fast, best"):
        recipe("slow")
    assert recipe("best").fine_tuning == replace(recipe("fast").fine_tuning, epochs=130)


def test_every_stage_lowers_its_loss():
    _, history = trained()
    assert list(history.losses) == ["layer 1", "layer 2", "fine tuning"]
    for losses in history.losses.values():
        assert len(losses) == 4
        assert losses[-1] < losses[0]


def test_each_stage_gets_the_clean_input_and_a_corrupted_copy(monkeypatch):
    """Layer 2 learns from what layer 1 makes of the clean windows, corrupted anew (Vincent)."""
    model, windows, calls = small_model(), waves(), []
    original = model.loss_and_gradients

    def recorded(x, corrupted, alpha, first, layer):
        below = windows
        if layer:
            below, _ = model.layers[0].encode_with_pullback(windows)
        whole = {window.tobytes() for window in below}
        if layer != 0:  # layer 1 is still moving while it trains, those above it are not
            assert all(window.tobytes() in whole for window in x)
        lost = corrupted != x
        assert np.all(corrupted[lost] == 0)
        calls.append((layer, alpha, first is not None, lost.mean()))
        return original(x, corrupted, alpha, first, layer)

    monkeypatch.setattr(model, "loss_and_gradients", recorded)
    stages = Schedule(layer=Stage(epochs=3), fine_tuning=Stage(epochs=2, rate=0.01, alpha=0.0))
    train_autoencoder(model, windows, stages, np.random.default_rng(0))
    assert [call[:3] for call in calls] == (
        [(0, 0.01, True)] * 36 + [(1, 0.01, True)] * 36 + [(None, 0.0, False)] * 24
    )
    assert np.mean([call[3] for call in calls]) == pytest.approx(0.1, abs=0.02)


def test_an_epoch_shows_every_window_once_in_a_new_order(monkeypatch):
    shown = []
    monkeypatch.setattr(
        layerwise, "denoising_step", lambda _, x, *more: shown.append(x[:, 0, 0]) or 1.0
    )
    windows = np.arange(10, dtype=np.float32)[:, None, None] * np.ones((1, 8, 3), np.float32)
    schedule = Schedule(Stage(epochs=2, batch=3), Stage(epochs=0))
    train_autoencoder(ConvAutoencoder(3, (4,), taps=3), windows, schedule)
    first, second = shown[:4], shown[4:]
    assert [len(batch) for batch in first] == [3, 3, 3, 1]
    assert sorted(np.concatenate(first)) == list(range(10))
    assert list(np.concatenate(first)) != list(np.concatenate(second))


def test_a_batch_steps_along_the_mean_of_its_gradients():
    """Two windows in one step move the weights by the mean of what each would do."""
    windows, rate = waves(2), 0.1
    moved = []
    for chosen in ([0], [1], [0, 1]):
        model = small_model()
        before = model.layers[0].w.copy()
        rng = np.random.default_rng(0)
        stage = Stage(alpha=0.0, zeroed=0.0)
        optimiser = make_optimiser(stage, model.parameters)
        x = windows[chosen]
        layerwise.denoising_step(model, x, x, stage, rate, rng, optimiser)
        moved.append(model.layers[0].w - before)
    np.testing.assert_allclose(moved[2], (moved[0] + moved[1]) / 2, rtol=1e-4, atol=1e-7)
