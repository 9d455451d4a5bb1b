"""Probabilistic PCA of fifteen frames: its likelihood, and what it says of missing values."""

import numpy as np
import pytest

from numpy_cae.manifold import learn_manifold, load_manifold, probabilistic_pca
from numpy_cae.manifold.probabilistic_pca import AXES, RIDGE, TAPS, ProbabilisticPCA
from numpy_cae.training import Schedule, Stage, Windows

COLUMNS = 3


def draw_frames(frames: int, seed: int = 0) -> np.ndarray:
    """Three columns that are mixtures of two noisy sines, (frames, 3)."""
    rng = np.random.default_rng(seed)
    sines = np.sin(np.arange(frames)[:, None] / [4.0, 7.0] + rng.random(2))
    mixed = sines @ np.random.default_rng(9).normal(size=(2, COLUMNS))
    return mixed + 0.1 * rng.normal(size=mixed.shape)


def fit(frames: np.ndarray, length: int = 40) -> ProbabilisticPCA:
    windows = Windows(frames, np.arange(0, len(frames) - length + 1, length // 2), length)
    context = ProbabilisticPCA.fit(windows, np.ones(len(frames), bool))
    assert context is not None
    return context


def test_the_estimate_is_the_conditional_mean(monkeypatch):
    """Of a Gaussian with the mean m and the covariance W Wᵀ + σ² I, of one row."""
    monkeypatch.setattr(probabilistic_pca, "AXES", 6)
    context = fit(draw_frames(400))
    assert context.axes.shape == (6, TAPS * COLUMNS)
    x = draw_frames(TAPS, seed=1)
    for share in (0.1, 0.5, 0.95):  # fewer known values than axes, and fewer unknown ones
        known = np.random.default_rng(2).random(x.shape) < share
        o = np.flatnonzero(known)
        w = context.axes.T
        mean_variance = np.trace(w @ w.T) / len(w) + context.noise
        for number, ridge in enumerate((0, RIDGE)):
            noise = context.noise + ridge * mean_variance
            covariance = w @ w.T + noise * np.eye(len(w))
            gap = x.ravel()[o] - context.mean[o]
            given = np.linalg.solve(covariance[np.ix_(o, o)], gap)
            expected = context.mean + (w @ w.T)[:, o] @ given
            estimate = context.estimate(np.where(known, x, 99), known)[number]
            np.testing.assert_allclose(estimate, expected.reshape(x.shape), atol=1e-8)


def test_the_likelihood_of_the_rows_is_largest(monkeypatch):
    """Another σ², or axes of another length, are less likely."""
    monkeypatch.setattr(probabilistic_pca, "AXES", 4)
    frames = draw_frames(300)
    context = fit(frames, length=TAPS)
    starts = np.arange(0, len(frames) - TAPS + 1, TAPS // 2)
    rows = np.stack([frames[start : start + TAPS].ravel() for start in starts])
    sample = np.cov(rows.T, bias=True)

    def log_likelihood(w: np.ndarray, noise: float) -> float:
        covariance = w @ w.T + noise * np.eye(len(w))
        _, log_determinant = np.linalg.slogdet(covariance)
        return -log_determinant - np.trace(np.linalg.solve(covariance, sample))

    best = log_likelihood(context.axes.T, context.noise)
    for factor in (0.9, 1.1):
        assert log_likelihood(context.axes.T, factor * context.noise) < best
        assert log_likelihood(factor * context.axes.T, context.noise) < best


@pytest.mark.parametrize("frames", [1, 8, TAPS, 16, 41])
def test_motions_of_any_length_are_completed(frames):
    context = fit(draw_frames(400))
    x = draw_frames(frames, seed=1)
    known = np.random.default_rng(2).random(x.shape) < 0.6
    completed = context.estimate(np.where(known, x, 99), known)
    assert completed.shape == (2, *x.shape)
    if frames > 1:
        assert np.sqrt(np.mean((completed - x)[:, ~known] ** 2)) < 0.5 * x.std()


def test_frames_that_do_not_count_are_not_fitted():
    frames = draw_frames(200)
    is_real = np.ones(200, bool)
    is_real[100:] = False
    frames[100:] = 50.0
    context = ProbabilisticPCA.fit(Windows(frames, np.arange(0, 161, 20), 40), is_real)
    assert context is not None
    assert np.abs(context.mean).max() < 1
    assert ProbabilisticPCA.fit(Windows(frames, np.array([100]), 40), is_real) is None
    assert ProbabilisticPCA.fit(Windows(frames, np.array([0]), TAPS - 1), is_real) is None


@pytest.mark.parametrize("frames", [TAPS, 100])
def test_frames_that_are_all_the_same_have_no_principal_components(frames):
    windows = Windows(np.ones((frames, COLUMNS)), np.array([0]), frames)
    assert ProbabilisticPCA.fit(windows, np.ones(frames, bool)) is None


def test_a_manifold_of_few_frames_is_saved(walk_takes, tmp_path):
    schedule = Schedule(layer=Stage(epochs=0), fine_tuning=Stage(epochs=1, rate=0.01))
    for frames in (TAPS - 1, TAPS, TAPS + 1):
        manifold = learn_manifold(
            [walk_takes[0][:frames]], schedule, window=16, filters=(4,), taps=3
        )
        manifold.save(tmp_path / "m.npz")
        loaded = load_manifold(tmp_path / "m.npz")
        assert (loaded.context is None) == (frames <= TAPS)


def test_there_are_at_most_so_many_axes():
    frames = np.random.default_rng(0).normal(size=(600, 25))
    context = ProbabilisticPCA.fit(Windows(frames, np.arange(0, 561, 40), 40), np.ones(600, bool))
    assert context is not None
    assert context.axes.shape == (AXES, TAPS * 25)
