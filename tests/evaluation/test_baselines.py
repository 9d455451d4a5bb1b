"""The simple methods against their definitions: PCA, the Gaussian, the linear map, curves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from numpy_cae.evaluation import PCA, baselines
from numpy_cae.evaluation.baselines import Gaussian, apply_linear_map, gather_context
from numpy_cae.evaluation.tables import interpolate_columns
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
    monkeypatch.setattr(baselines, "MIDDLE", 1)
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


def test_the_gaussian_estimates_the_conditional_mean_of_seven_frames_in_fifteen():
    rng = np.random.default_rng(1)
    x = np.cumsum(rng.normal(size=(60, 23, 2)), axis=1)
    fitted = Gaussian(x, np.ones((60, 23), bool))
    rows = np.pad(x, ((0, 0), (7, 7), (0, 0)))
    rows = np.stack([rows[n, t : t + 15].ravel() for n in range(60) for t in range(23)])
    mean = rows.mean(axis=0)
    covariance = np.cov(rows.T, bias=True)
    covariance += baselines.RIDGE * np.diag(covariance).mean() * np.eye(30)
    known = rng.random((23, 2)) < 0.5
    known[15:] = True
    expected = x[0].copy()
    for start in (0, 7, 14):
        o = [(t, c) for t in range(start - 4, start + 11) for c in (0, 1) if 0 <= t < 23]
        o = [(t, c) for t, c in o if known[t, c]]
        at = [2 * (t - start + 4) + c for t, c in o]
        gap = np.array([x[0, t, c] for t, c in o]) - mean[at]
        weights = np.linalg.solve(covariance[np.ix_(at, at)], gap)
        for t, c in np.argwhere(~known[start : start + 7]) + [start, 0]:
            place = 2 * (t - start + 4) + c
            expected[t, c] = mean[place] + covariance[place, at] @ weights
    completed = fitted.complete(np.where(known, x[:1], 99), known[None])[0]
    np.testing.assert_allclose(completed, expected, atol=1e-6)


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
