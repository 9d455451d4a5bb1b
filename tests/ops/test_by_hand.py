"""What the definitions by loops leave open: no frames, and the dtype of an upstream number."""

import numpy as np
import pytest

from numpy_cae import ops


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
