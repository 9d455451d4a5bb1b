"""PCA is exact on its own subspace and the best linear projection."""

import numpy as np
import pytest

from numpy_cae.evaluation import PCA


def test_rows_of_low_rank_are_exact():
    rng = np.random.default_rng(0)
    rows = rng.normal(size=(40, 3)) @ rng.normal(size=(3, 9)) + rng.normal(size=9)
    pca = PCA.fit(rows)
    np.testing.assert_allclose(pca.project(rows, 3), rows)
    stacked = rows.reshape(8, 5, 9)
    np.testing.assert_allclose(pca.project(stacked, 2).reshape(40, 9), pca.project(rows, 2))
    assert np.abs(pca.project(rows, 2) - rows).max() > 0.1


def test_error_is_the_variance_of_the_axes_left_out():
    rng = np.random.default_rng(1)
    rows = rng.normal(size=(60, 5)) * [5, 4, 3, 2, 1]
    pca = PCA.fit(rows)
    left = np.linalg.eigvalsh(np.cov(rows.T, bias=True))[:3].sum()
    assert np.sum((pca.project(rows, 2) - rows) ** 2) / 60 == pytest.approx(left)


def test_missing_entries_are_the_conditional_mean_of_a_gaussian():
    rng = np.random.default_rng(3)
    rows = rng.normal(size=(4000, 3)) @ rng.normal(size=(3, 3))
    pca = PCA.fit(rows)
    mean, cov = rows.mean(axis=0), np.cov(rows.T, bias=True)
    expected = mean[2] + cov[2, :2] @ np.linalg.solve(cov[:2, :2], rows[0, :2] - mean[:2])
    filled = pca.fill(rows[:1], np.array([[True, True, False]]), 3)
    assert filled[0, 2] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("shape", [(400, 63), (60, 300)])
def test_the_axes_are_those_of_a_singular_value_decomposition(shape):
    rng = np.random.default_rng(4)
    rows = rng.normal(size=(shape[0], 12)) @ rng.normal(size=(12, shape[1])) + 3
    rows += 1e-2 * rng.normal(size=shape)
    pca = PCA.fit(rows.astype(np.float32))
    rows = rows.astype(np.float32).astype(np.float64)
    mean = rows.mean(axis=0)
    _, spread, axes = np.linalg.svd(rows - mean, full_matrices=False)
    count = len(pca.axes)
    np.testing.assert_allclose(pca.variances, spread[:count] ** 2 / len(rows), rtol=1e-6)
    assert count >= min(shape) - 1
    new = rng.normal(size=(5, shape[1]))
    for size in (1, 12, 40):
        expected = mean + (new - mean) @ axes[:size].T @ axes[:size]
        np.testing.assert_allclose(pca.project(new, size), expected, atol=1e-7)
    np.testing.assert_allclose(pca.axes @ pca.axes.T, np.eye(count), atol=1e-7)
