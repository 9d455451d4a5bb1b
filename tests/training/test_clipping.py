"""Clipping the gradient's norm: one factor for all, and none below the bound."""

import numpy as np
import pytest

from numpy_cae.training import clip_norm


def test_a_long_gradient_keeps_its_direction():
    one, two = np.array([3.0, 0.0]), np.array([[0.0, 4.0]])
    assert clip_norm([one, two], 1.0) == pytest.approx(5)
    np.testing.assert_allclose(one, [0.6, 0])
    np.testing.assert_allclose(two, [[0, 0.8]])


def test_a_short_gradient_is_left_alone():
    one, two = np.array([0.3, 0.0]), np.array([[0.0, 0.4]])
    assert clip_norm([one, two], 1.0) == pytest.approx(0.5)
    np.testing.assert_array_equal(one, [0.3, 0])
    np.testing.assert_array_equal(two, [[0, 0.4]])


def test_float32_stays_float32():
    gradient = np.full(5, 100, np.float32)
    clip_norm([gradient], 2.0)
    assert gradient.dtype == np.float32
    assert np.linalg.norm(gradient) == pytest.approx(2, rel=1e-6)


@pytest.mark.parametrize("bound", [0.0, -1.0, float("nan")])
def test_a_bound_must_be_above_zero(bound):
    with pytest.raises(ValueError, match="above 0"):
        clip_norm([np.ones(2)], bound)
