"""What each filter preserves exactly, and what it removes."""

import numpy as np
import pytest

from numpy_cae.evaluation import median, savitzky_golay


def test_the_median_removes_an_outlier_and_keeps_an_edge():
    step = np.repeat([0.0, 1.0], 10)
    x = np.tile(step[:, None], (2, 1, 1))
    spoilt = x.copy()
    spoilt[0, 4], spoilt[1, 14] = 50.0, -50.0
    np.testing.assert_array_equal(median(spoilt, 5), x)


@pytest.mark.parametrize("smooth", [median, lambda x, length: savitzky_golay(x, length, 2)])
def test_features_and_windows_do_not_mix(smooth):
    x = np.random.default_rng(0).normal(size=(3, 20, 4))
    smoothed = smooth(x, 5)
    assert smoothed.shape == x.shape
    assert not np.allclose(smoothed, x)
    for window, feature in np.ndindex(3, 4):
        alone = smooth(x[window, :, [feature]].T, 5)[:, 0]
        np.testing.assert_allclose(smoothed[window, :, feature], alone, atol=1e-12)


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_savitzky_golay_preserves_polynomials_of_its_order(order):
    t = np.linspace(-1, 1, 31)[:, None]
    x = sum((k + 1) * t**k for k in range(order + 1))
    np.testing.assert_allclose(savitzky_golay(x, 9, order), x, atol=1e-9)
