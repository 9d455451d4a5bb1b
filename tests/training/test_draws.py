"""What is drawn while training: how likely, in which precision, and at the very edges."""

import numpy as np
import pytest

from numpy_cae.training import descend, layerwise, zero_values


class Constant:
    """A generator whose every draw is the same number; drawn in float32, half the work."""

    def __init__(self, number):
        self.number = number

    def random(self, shape, dtype):
        assert dtype == np.float32
        return np.full(shape, self.number, dtype)


X = np.ones((2, 4, 3))


def test_a_draw_of_exactly_p_loses_nothing():
    """Draws lie in [0, 1): below p, not up to p, has the probability p; and p = 0 loses none."""
    assert zero_values(X, 0.0, Constant(0.0)).all()
    assert zero_values(X, 0.5, Constant(0.5)).all()
    assert not zero_values(X, 0.5, Constant(0.4999)).any()


def test_a_mask_is_true_in_half_of_all_cases():
    assert layerwise._drawn_mask(X, 5, Constant(0.4999)).all()
    assert not layerwise._drawn_mask(X, 5, Constant(0.5)).any()
    assert layerwise._drawn_mask(X, 5, Constant(0)).shape == (2, 2, 5)
    drawn = layerwise._drawn_mask(np.ones((10, 100, 1)), 20, np.random.default_rng(0))
    assert drawn.dtype == bool
    assert drawn.mean() == pytest.approx(0.5, abs=0.02)


def test_a_parameter_without_a_gradient_is_an_error():
    w, b = np.ones(2), np.ones(1)
    with pytest.raises(ValueError, match="shorter"):
        descend((w, b), (np.ones(2),), rate=0.1)
