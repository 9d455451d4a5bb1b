"""Costs of other methods beside the network's training: kernels, trees, PCA."""

import numpy as np
import pytest

from studies import scaling
from studies.scaling import fit_kernel_pca, fit_landmarks, squared_distances


def test_a_power_is_found_in_costs():
    assert scaling._slope((2, 4, 8), (12.0, 48.0, 192.0)) == pytest.approx(2.0)


def test_the_memory_of_a_matrix_of_all_pairs_grows_as_the_square():
    power = scaling._slope_of_memory(lambda count: np.zeros((count, count)), (200, 400, 800))
    assert power == pytest.approx(2.0, abs=0.02)


def test_distances_are_those_of_all_pairs():
    rows = np.random.default_rng(0).normal(size=(5, 3))
    gaps = rows[:, None] - rows[None]
    np.testing.assert_allclose(squared_distances(rows, rows), (gaps**2).sum(axis=2), atol=1e-12)


def kernel_of(rows, scale):
    return np.exp(-squared_distances(rows, rows) / scale)


def test_kernel_pca_has_the_inner_products_of_the_centred_kernel():
    rows = np.random.default_rng(0).normal(size=(12, 3))
    kernel = kernel_of(rows, np.median(squared_distances(rows, rows)))
    centre = np.eye(12) - 1 / 12
    coordinates = fit_kernel_pca(rows)
    np.testing.assert_allclose(coordinates @ coordinates.T, centre @ kernel @ centre, atol=1e-9)


def test_landmarks_that_are_all_rows_give_the_kernel(monkeypatch):
    monkeypatch.setattr(scaling, "LANDMARKS", 12)
    rows = np.random.default_rng(0).normal(size=(12, 3))
    kernel = kernel_of(rows, np.median(squared_distances(rows, rows)))
    coordinates = fit_landmarks(rows)
    np.testing.assert_allclose(coordinates @ coordinates.T, kernel, atol=1e-6)


def test_every_method_is_judged(result_of):
    keys = {claim.key for claim in result_of("scaling").claims}
    assert {"kernels_grow", "trees_expensive", "pca_scales"} < keys
