"""PCA against what it must be: exact on its own subspace, the best linear projection."""

import numpy as np
import pytest

from numpy_cae.baselines import PCA


def test_rows_of_low_rank_come_back_exactly():
    rng = np.random.default_rng(0)
    rows = rng.normal(size=(40, 3)) @ rng.normal(size=(3, 9)) + rng.normal(size=9)
    pca = PCA.fit(rows)
    np.testing.assert_allclose(pca.project(rows, 3), rows)
    assert np.abs(pca.project(rows, 2) - rows).max() > 0.1


def test_error_is_the_variance_of_the_axes_left_out():
    rng = np.random.default_rng(1)
    rows = rng.normal(size=(60, 5)) * [5, 4, 3, 2, 1]
    pca = PCA.fit(rows)
    left = np.linalg.eigvalsh(np.cov(rows.T, bias=True))[:3].sum()
    assert np.sum((pca.project(rows, 2) - rows) ** 2) / 60 == pytest.approx(left)
