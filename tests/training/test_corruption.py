"""Corruption: a share of values; and where a layer unpools."""

import numpy as np
import pytest

from numpy_cae.training import Stage
from numpy_cae.training.corruption import corrupt, unpooling_mask

X = np.random.default_rng(1).normal(size=(40, 160, 9)).astype(np.float32)


@pytest.mark.parametrize("rescaled", [False, True])
@pytest.mark.parametrize("zeroed", [(0.0, 0.0), (0.1, 0.1), (0.5, 0.5), (0.2, 0.8), (1.0, 1.0)])
def test_a_share_p_is_zeroed_and_the_others_are_kept_or_divided_by_1_minus_p(zeroed, rescaled):
    before = X.copy()
    low, high = zeroed
    stage = Stage(zeroed=zeroed if low < high else low, rescaled=rescaled and high < 1)
    corrupted = corrupt(X, stage, np.random.default_rng(0))
    assert corrupted.dtype == np.float32
    np.testing.assert_array_equal(X, before)
    lost = corrupted == 0
    shares = lost.mean(axis=(1, 2))  # of 1440 values a window
    assert low - 0.05 < shares.min() < low + 0.1 and high - 0.1 < shares.max() < high + 0.05
    assert lost.mean() == pytest.approx((low + high) / 2, abs=0.01 if low == high else 0.1)
    for window, is_clean, share in zip(corrupted / X, ~lost, shares, strict=True):
        factor = 1 / (1 - share) if stage.rescaled else 1.0
        assert np.ptp(window[is_clean], axis=0) < 1e-5 if is_clean.any() else share == 1
        np.testing.assert_allclose(window[is_clean], factor, rtol=0.15 if stage.rescaled else 1e-6)


def test_a_mask_is_as_often_true_as_false():
    mask = unpooling_mask(np.ones((10, 400, 3)), 20, np.random.default_rng(0))
    assert mask.shape == (10, 200, 20) and mask.dtype == bool
    assert mask.mean() == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("p", [1.5, (1.2, 1.5)])
def test_a_probability_above_one_is_an_error(p):
    with pytest.raises(ValueError, match="expected a probability"):
        corrupt(X, Stage(zeroed=p), np.random.default_rng(0))
