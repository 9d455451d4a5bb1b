"""Small examples with numbers that a reader can follow on paper."""

import numpy as np
import pytest

from numpy_cae import ops


def test_conv1d_of_a_pulse_is_the_filter_in_reverse():
    pulse = np.array([0.0, 0.0, 1.0, 0.0, 0.0]).reshape(1, 5, 1)
    w = np.array([1.0, 2.0, 3.0]).reshape(3, 1, 1)
    y, pullback = ops.conv1d(pulse, w, np.array([10.0]))
    assert y.ravel().tolist() == [10, 13, 12, 11, 10]
    dx, dw, db = pullback(pulse)
    assert dx.ravel().tolist() == [0, 1, 2, 3, 0]
    assert dw.ravel().tolist() == [0, 1, 0]
    assert db.tolist() == [1]


def test_pooling_and_its_two_inverses():
    x = np.array([1.0, 3.0, 5.0, 2.0, 4.0, 4.0]).reshape(1, 6, 1)
    y, pullback = ops.max_pool(x)
    assert y.ravel().tolist() == [3, 5, 4]
    dx = pullback(np.array([1.0, 2.0, 3.0]).reshape(y.shape))
    assert dx.ravel().tolist() == [0, 1, 2, 0, 3, 0]
    assert ops.unpool_even(y)[0].ravel().tolist() == [1.5, 1.5, 2.5, 2.5, 2, 2]
    first = np.array([True, False, True]).reshape(y.shape)
    assert ops.unpool_random(y, first)[0].ravel().tolist() == [3, 0, 0, 5, 4, 0]


def test_gru_of_no_frames_passes_no_gradient():
    weights = (np.ones((2, 3)), np.ones((1, 3)), np.ones(3), np.ones(3))
    y, pullback = ops.gru(np.ones((1, 0, 2)), np.ones((1, 1)), *weights)
    assert y.shape == (1, 0, 1)
    dx, dh0, *of_weights = pullback(y)
    assert dx.shape == (1, 0, 2) and dh0.tolist() == [[0.0]]
    assert all(not gradient.any() for gradient in of_weights)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_losses_keep_the_dtype_whatever_the_upstream_number(dtype):
    y = np.array([1.0, -2.0], dtype)
    for _, pullback in (
        ops.mean_absolute(y),
        ops.mean_squared_error(y, 0 * y),
        ops.sliced_wasserstein(y[:, None], 0 * y[:, None], np.ones((1, 1), dtype)),
    ):
        assert pullback(np.float64(0.1)).dtype == dtype
