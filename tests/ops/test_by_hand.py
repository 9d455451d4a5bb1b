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


def test_conv1d_with_more_taps_than_frames():
    w = np.arange(1.0, 8.0).reshape(7, 1, 1)
    y, pullback = ops.conv1d(np.ones((1, 2, 1)), w, np.zeros(1))
    assert y.ravel().tolist() == [4 + 5, 3 + 4]
    dx, dw, _ = pullback(np.ones((1, 2, 1)))
    assert dx.ravel().tolist() == [4 + 3, 5 + 4]
    assert dw.ravel().tolist() == [0, 0, 1, 2, 1, 0, 0]


def test_transpose_filters():
    w = np.array([[[1.0, 2.0]], [[3.0, 4.0]], [[5.0, 6.0]]])
    w_tilde, _ = ops.transpose_filters(w)
    assert w_tilde.tolist() == [[[5], [6]], [[3], [4]], [[1], [2]]]


def test_pooling_and_its_two_inverses():
    x = np.array([1.0, 3.0, 5.0, 2.0, 4.0, 4.0]).reshape(1, 6, 1)
    y, pullback = ops.max_pool(x)
    assert y.ravel().tolist() == [3, 5, 4]
    assert pullback(np.array([1.0, 2.0, 3.0]).reshape(y.shape)).ravel().tolist() == [
        0,
        1,
        2,
        0,
        3,
        0,
    ]
    assert ops.unpool_even(y)[0].ravel().tolist() == [1.5, 1.5, 2.5, 2.5, 2, 2]
    first = np.array([True, False, True]).reshape(y.shape)
    assert ops.unpool_random(y, first)[0].ravel().tolist() == [3, 0, 0, 5, 4, 0]


def test_arctanh_is_clipped_at_its_bound_and_not_before():
    y = np.array([-2.0, -0.5, 0.5, 0.500001, 1.0])
    x, pullback = ops.arctanh(y, 0.5)
    edge = np.arctanh(0.5)
    np.testing.assert_allclose(x, [-edge, -edge, edge, edge, edge])
    np.testing.assert_allclose(pullback(np.ones(5)), [0, 1 / 0.75, 1 / 0.75, 0, 0])


def test_losses():
    loss, pullback = ops.mean_squared_error(np.array([1.0, 5.0]), np.array([0.0, 2.0]))
    assert loss == 5
    assert pullback().tolist() == [1, 3]
    assert pullback(2.0).tolist() == [2, 6]
    loss, pullback = ops.mean_absolute(np.array([-3.0, 0.0, 1.0, 4.0]))
    assert loss == 2
    assert pullback().tolist() == [-0.25, 0, 0.25, 0.25]
    assert pullback(4.0).tolist() == [-1, 0, 1, 1]


def test_gru_keeps_its_state_where_update_is_shut():
    h = np.array([[0.3, -0.7]])
    shut = np.array([0.0, 0, 50, 50, 0, 0])
    zeros = np.zeros((2, 6))
    h_next, _ = ops.gru_step(np.ones((1, 2)), h, zeros, zeros, shut, np.zeros(6))
    np.testing.assert_allclose(h_next, h)


def test_gru_of_no_frames_passes_no_gradient():
    weights = (np.ones((2, 3)), np.ones((1, 3)), np.ones(3), np.ones(3))
    y, pullback = ops.gru(np.ones((1, 0, 2)), np.ones((1, 1)), *weights)
    assert y.shape == (1, 0, 1)
    dx, dh0, *of_weights = pullback(y)
    assert dx.shape == (1, 0, 2) and dh0.tolist() == [[0.0]]
    assert all(not gradient.any() for gradient in of_weights)


def test_sliced_wasserstein_pairs_by_rank():
    z, prior = np.array([[3.0], [0.0]]), np.array([[1.0], [2.0]])
    loss, pullback = ops.sliced_wasserstein(z, prior, np.array([[1.0]]))
    assert loss == 1  # 0 meets 1, 3 meets 2
    assert pullback().tolist() == [[1], [-1]]
    assert pullback(3.0).tolist() == [[3], [-3]]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_losses_keep_the_dtype_whatever_the_upstream_number(dtype):
    y = np.array([1.0, -2.0], dtype)
    for _, pullback in (
        ops.mean_absolute(y),
        ops.mean_squared_error(y, 0 * y),
        ops.sliced_wasserstein(y[:, None], 0 * y[:, None], np.ones((1, 1), dtype)),
    ):
        assert pullback(np.float64(0.1)).dtype == dtype
