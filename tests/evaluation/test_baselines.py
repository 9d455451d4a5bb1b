"""The simple methods against their definitions: PCA, the Gaussian, the linear map, curves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from numpy_cae.evaluation import PCA, baselines
from numpy_cae.evaluation.baselines import (
    Gaussian,
    apply_linear_map,
    fit_gaussian,
    gather_context,
)
from numpy_cae.evaluation.joint_ridge import JointRidge
from numpy_cae.evaluation.pose_dynamics import PoseDynamics
from numpy_cae.evaluation.tables import apply_to_real_frames, interpolate_columns
from numpy_cae.manifold.completion import interpolate_gaps


@pytest.mark.parametrize("shape", [(400, 63), (60, 300)])
def test_the_axes_are_those_of_a_singular_value_decomposition(shape):
    rng = np.random.default_rng(4)
    rows = rng.normal(size=(shape[0], 12)) @ rng.normal(size=(12, shape[1])) + 3
    rows = (rows + 1e-2 * rng.normal(size=shape)).astype(np.float32)
    pca, mean = PCA.fit(rows), rows.mean(axis=0, dtype=np.float64)
    axes = np.linalg.svd(rows - mean, full_matrices=False)[2]
    count = len(pca.axes)
    assert count >= min(shape) - 1
    new = rng.normal(size=(2, 3, shape[1]))
    for size in (1, 12, 40):
        expected = mean + (new - mean) @ axes[:size].T @ axes[:size]
        np.testing.assert_allclose(pca.project(new, size), expected, atol=1e-7)
    np.testing.assert_allclose(pca.axes @ pca.axes.T, np.eye(count), atol=1e-7)


@pytest.fixture
def windows(monkeypatch):
    """Smooth and correlated, like motion: sums of slow waves; rows of three frames, no ridge."""
    monkeypatch.setattr(baselines, "TAPS", 3)
    monkeypatch.setattr(baselines, "RIDGE", 0.0)
    rng = np.random.default_rng(0)
    t = np.arange(40) / 40
    waves = np.stack([np.sin(2 * np.pi * (k * t + rng.random((30, 1)))) for k in (1, 2, 3)], -1)
    return waves @ rng.normal(size=(3, 2)) + 0.3 * rng.normal(size=(30, 40, 2))


def test_the_linear_map_solves_the_normal_equations_over_all_masks(windows):
    """Summed over all 2^6 masks of six values, each by its probability."""
    fitted, size = Gaussian(windows, np.ones((30, 40), bool)), 6
    z = np.concatenate([gather_context(window) for window in windows])
    m, b = np.zeros((size, size)), np.zeros((size, 2))
    for bits in range(2**size):
        mask = np.array([bits >> i & 1 for i in range(size)])
        chance = 0.7 ** mask.sum() * 0.3 ** (size - mask.sum()) / len(z)
        m += chance * (mask * z).T @ (mask * z)
        b += chance * (mask * z).T @ windows.reshape(-1, 2)
    np.testing.assert_allclose(m @ fitted.linear_map(0.3), b, rtol=1e-6, atol=1e-12)
    weights = np.array([100.0, 10.0, 1.0]).reshape(3, 1)
    padded_with_zeros = apply_linear_map(np.array([1.0, 2.0, 3.0]).reshape(1, 3, 1), weights)
    assert padded_with_zeros.ravel().tolist() == [12, 123, 230]


def test_the_gaussian_averages_conditional_means_of_overlapping_rows():
    """Its moments are those of rows of which all frames count."""
    rng = np.random.default_rng(1)
    x = np.cumsum(rng.normal(size=(60, 23, 2)), axis=1)
    real = np.ones((60, 23), bool)
    real[40:, 20:] = False
    fitted = Gaussian(x * real[..., None], real)
    rows = np.stack(
        [x[n, t : t + 15].ravel() for n in range(60) for t in range(9 if n < 40 else 6)]
    )
    mean = rows.mean(axis=0)
    covariance = np.cov(rows.T, bias=True)
    covariance += baselines.RIDGE * np.diag(covariance).mean() * np.eye(30)
    known = rng.random((23, 2)) < 0.5
    totals = np.zeros((23, 2))
    weights = np.zeros((23, 1))
    hann = np.sin(np.pi * (np.arange(15) + 0.5) / 15)[:, None] ** 2
    for start in (0, 5, 8):
        o = np.flatnonzero(known[start : start + 15])
        gap = x[0, start : start + 15].ravel()[o] - mean[o]
        row = mean + covariance[:, o] @ np.linalg.solve(covariance[np.ix_(o, o)], gap)
        totals[start : start + 15] += hann * row.reshape(15, 2)
        weights[start : start + 15] += hann
    expected = np.where(known, x[0], totals / weights)
    completed = fitted.complete(np.where(known, x[:1], 99), known[None])[0]
    np.testing.assert_allclose(completed, expected, atol=1e-6)


def test_the_gaussian_completes_a_window_shorter_than_a_row():
    x = np.cumsum(np.random.default_rng(1).normal(size=(60, 23, 2)), axis=1)
    fitted = Gaussian(x, np.ones((60, 23), bool))
    known = np.ones((1, 8, 2), bool)
    known[0, 3, 1] = False
    completed = fitted.complete(np.where(known, x[:1, :8], 99), known)
    assert abs(completed[0, 3, 1] - x[0, 3, 1]) < 2


def test_the_ridge_is_the_best_on_takes_left_out():
    """Of noisy values a larger ridge is better than of values without noise."""
    rng = np.random.default_rng(2)
    t = np.arange(40) / 40
    phases = rng.random((50, 1))
    clean = np.stack([np.sin(2 * np.pi * (k * t + phases)) for k in (1, 2, 3)], axis=-1)
    noisy = clean + rng.normal(size=clean.shape)
    real = np.ones(clean.shape[:2], bool)
    fit = [fit_gaussian(x, real, np.arange(50)).ridge for x in (clean, noisy)]
    assert fit[0] < fit[1]


def test_without_a_take_to_leave_out_the_ridge_is_the_default():
    x = np.cumsum(np.random.default_rng(1).normal(size=(2, 23, 2)), axis=1)
    assert fit_gaussian(x, np.ones((2, 23), bool), np.arange(2)).ridge == baselines.RIDGE


def test_the_kalman_smoother_is_the_conditional_mean():
    """Of all states and known values at once, in one large Gaussian."""
    rng = np.random.default_rng(3)
    takes = [np.cumsum(rng.normal(size=(60, 4)), axis=0) @ rng.normal(size=(4, 4)) for _ in "abc"]
    model = PoseDynamics(takes, components=2)
    frames = 6
    size = len(model.start)
    transition = np.zeros((size, size))
    transition[:2] = np.concatenate([np.diag(weights) for weights in model.lag_weights], axis=1)
    transition[2:, :-2] = np.eye(size - 2)
    step = np.zeros((size, size))
    step[:2, :2] = np.diag(model.excitation)
    states = np.zeros((frames * size, frames * size))
    spread = model.start
    for t in range(frames):
        row = spread
        for later in range(t, frames):
            states[t * size : (t + 1) * size, later * size : (later + 1) * size] = row
            states[later * size : (later + 1) * size, t * size : (t + 1) * size] = row.T
            row = row @ transition.T
        spread = transition @ spread @ transition.T + step
    seen = np.zeros((4, size))
    seen[:, :2] = model.axes.T
    emit = np.kron(np.eye(frames), seen)
    values = emit @ states @ emit.T + np.kron(np.eye(frames), np.diag(model.noise))
    x = takes[0][:frames]
    known = rng.random(x.shape) < 0.6
    o = np.flatnonzero(known)
    gap = (x - model.mean).ravel()[o]
    state = states @ emit.T[:, o] @ np.linalg.solve(values[np.ix_(o, o)], gap)
    expected = np.where(known, x, model.mean + (emit @ state).reshape(x.shape))
    completed = model.complete(np.where(known, x, 99)[None], known[None])[0]
    np.testing.assert_allclose(completed, expected, rtol=1e-5, atol=1e-5)


def test_the_regression_of_joints_finds_a_linear_relation():
    rng = np.random.default_rng(4)
    takes = [rng.normal(size=(30, 4)) for _ in range(6)]
    for take in takes:
        before = take[[0, *range(29)], 1]
        take[:, 3] = 2 * take[:, 0] - before + 5
    fitted = JointRidge.fit(takes, np.array([3]), lags=(0, -1))
    np.testing.assert_allclose(fitted.predict(takes[0])[:, 0], takes[0][:, 3], atol=1e-3)


def test_the_regression_of_joints_does_not_read_what_is_hidden():
    rng = np.random.default_rng(4)
    takes = [rng.normal(size=(30, 4)) for _ in range(6)]
    fitted = JointRidge.fit(takes, np.array([3]))
    hidden = takes[0].copy()
    hidden[:, 3] = np.nan
    np.testing.assert_array_equal(fitted.predict(hidden), fitted.predict(takes[0]))


def test_no_method_is_given_frames_that_pad_a_take():
    lengths = []
    real = np.arange(8) < np.array([[8], [5], [8]])
    x = np.arange(24.0).reshape(3, 8, 1)

    def repair(part):
        lengths.append(part.shape[:2])
        return part + 1

    repaired = apply_to_real_frames(repair, real, x)
    assert sorted(lengths) == [(1, 5), (2, 8)]
    np.testing.assert_array_equal(repaired[..., 0], np.where(real, x[..., 0] + 1, 0))


@given(seed=st.integers(0, 2**32 - 1))
def test_curves_are_those_of_scipy_and_numpy(seed):
    """Beside a gap of more than twelve frames the slopes of the spline are limited."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(2, 60, 3)).round(rng.integers(3))
    known = rng.random(x.shape) < rng.random()
    curve = interpolate_gaps(x, known)
    line = interpolate_columns(x, known, np.interp)
    frames = np.arange(60)
    for window, column in np.ndindex(2, 3):
        keys = np.flatnonzero(known[window, :, column])
        values = x[window, keys, column]
        expected = np.zeros(60)
        straight = np.zeros(60)
        if len(keys):
            straight = np.interp(frames, keys, values)
            expected = straight
        if len(keys) > 1:
            slopes = CubicSpline(keys, values, bc_type="natural")(keys, 1)
            for n, (gap, rise) in enumerate(zip(np.diff(keys), np.diff(values), strict=True)):
                if gap > 12:
                    slopes[n : n + 2] = slopes[n : n + 2].clip(*sorted((0, 3 * rise / gap)))
            expected = CubicHermiteSpline(keys, values, slopes)(frames.clip(keys[0], keys[-1]))
        np.testing.assert_allclose(curve[window, :, column], expected, atol=1e-9)
        np.testing.assert_allclose(line[window, :, column], straight, atol=1e-9)
