"""The simple methods against their definitions: PCA, the linear denoiser, interpolation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from numpy_cae.evaluation import PCA
from numpy_cae.manifold.complete import interpolated
from studies.shared.linear_denoiser import LinearDenoiser, Moments, contexts

TAPS = 5


@pytest.mark.parametrize("shape", [(400, 63), (60, 300)])
def test_the_axes_are_those_of_a_singular_value_decomposition(shape):
    rng = np.random.default_rng(4)
    rows = rng.normal(size=(shape[0], 12)) @ rng.normal(size=(12, shape[1])) + 3
    rows = (rows + 1e-2 * rng.normal(size=shape)).astype(np.float32)
    pca, mean = PCA.fit(rows), rows.mean(axis=0, dtype=np.float64)
    _, spread, axes = np.linalg.svd(rows - mean, full_matrices=False)
    count = len(pca.axes)
    np.testing.assert_allclose(pca.variances, spread[:count] ** 2 / len(rows), rtol=1e-6)
    assert count >= min(shape) - 1
    new = rng.normal(size=(2, 3, shape[1]))
    for size in (1, 12, 40):
        expected = mean + (new - mean) @ axes[:size].T @ axes[:size]
        np.testing.assert_allclose(pca.project(new, size), expected, atol=1e-7)
    np.testing.assert_allclose(pca.axes @ pca.axes.T, np.eye(count), atol=1e-7)


def test_missing_entries_are_the_conditional_mean_of_a_gaussian():
    rng = np.random.default_rng(3)
    rows = rng.normal(size=(4000, 3)) @ rng.normal(size=(3, 3))
    pca = PCA.fit(rows)
    mean, cov = rows.mean(axis=0), np.cov(rows.T, bias=True)
    expected = mean[2] + cov[2, :2] @ np.linalg.solve(cov[:2, :2], rows[0, :2] - mean[:2])
    filled = pca.fill(rows[:1], np.array([[True, True, False]]), 3)
    assert filled[0, 2] == pytest.approx(expected, rel=1e-4)


@pytest.fixture(scope="module")
def windows():
    """Smooth and correlated, like motion: sums of slow waves."""
    rng = np.random.default_rng(0)
    t = np.arange(40) / 40
    waves = np.stack([np.sin(2 * np.pi * (k * t + rng.random((30, 1)))) for k in (1, 2, 3)], -1)
    return waves @ rng.normal(size=(3, 2)) + 0.3 * rng.normal(size=(30, 40, 2))


@pytest.mark.parametrize("kept", [(0.7, 0.7), (0.7, 0.4), (1.0, 1e-9)])
def test_the_weights_solve_the_normal_equations_over_all_masks(windows, kept):
    """The normal equations summed over all 2^6 masks of six values, each by its probability, have
    the analytic solution."""
    moments = Moments.of(windows, np.ones((30, 40), bool), taps=3)
    z, k, size = contexts(windows, 3).reshape(-1, 6), np.tile(kept, 3), 6
    m, b = np.zeros((size, size)), np.zeros((size, 2))
    for bits in range(2**size):
        mask = np.array([bits >> i & 1 for i in range(size)])
        chance = np.prod(np.where(mask, k, 1 - k)) / len(z)
        m += chance * (mask * z).T @ (mask * z)
        b += chance * (mask * z).T @ windows.reshape(-1, 2)
    solved = moments.solve(np.array(kept), ridge=0).weights.reshape(size, 2)
    np.testing.assert_allclose(m @ solved, b, rtol=1e-6, atol=1e-12)


def test_padded_frames_do_not_count_and_repair_pads_with_zeros(windows):
    real = np.ones((30, 40), bool)
    real[:, 30:] = False
    changed = windows.copy()
    changed[:, 30 + TAPS // 2 :] = 100.0
    ours, theirs = (Moments.of(x, real, TAPS).second for x in (windows, changed))
    np.testing.assert_array_equal(ours, theirs)
    weights = np.array([100.0, 10.0, 1.0]).reshape(3, 1, 1)
    repaired = LinearDenoiser(weights).repair(np.array([1.0, 2.0, 3.0]).reshape(1, 3, 1))
    assert repaired.ravel().tolist() == [12, 123, 230]


@given(st.integers(0, 2**32 - 1))
def test_lines_are_restored_from_any_holes(seed):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(2, 1, 3)) * np.arange(40)[:, None] + rng.normal(size=(2, 1, 3))
    known = rng.random(x.shape) < 0.3
    known[:, [0, -1]] = True
    filled = interpolated(np.where(known, x, 0), known)
    np.testing.assert_allclose(filled, x, atol=1e-9)
