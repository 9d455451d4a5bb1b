"""Corruption with a p of its own for each window, and what rescaling restores."""

import numpy as np
import pytest

from numpy_cae.training import Stage, layerwise, zero_values
from numpy_cae.training.corruption import corrupt

X = np.random.default_rng(1).normal(size=(40, 160, 9)).astype(np.float32)


def shares(corrupted):
    return (corrupted == 0).mean(axis=(1, 2))


def test_each_window_draws_its_own_p_between_the_two():
    lost = shares(corrupt(X, (0.2, 0.8), False, np.random.default_rng(0)))
    assert 0.15 < lost.min() < 0.3
    assert 0.7 < lost.max() < 0.85
    assert lost.mean() == pytest.approx(0.5, abs=0.1)


def test_one_p_draws_what_it_always_drew():
    """The schedules that were measured with one p stay the same to the bit."""
    old = zero_values(X, 0.1, np.random.default_rng(0))
    np.testing.assert_array_equal(corrupt(X, 0.1, False, np.random.default_rng(0)), old)


@pytest.mark.parametrize("zeroed", [0.5, (0.1, 0.9)])
def test_rescaled_input_has_the_mean_of_the_whole(zeroed):
    ones = np.ones((60, 160, 9), np.float32)
    corrupted = corrupt(ones, zeroed, True, np.random.default_rng(0))
    assert corrupted.dtype == np.float32
    # 1440 values a window, at p = 0.9 of which a tenth is kept, ten times as large.
    np.testing.assert_allclose(corrupted.mean(axis=(1, 2)), 1, atol=5 * 3 / np.sqrt(1440))
    plain = corrupt(ones, zeroed, False, np.random.default_rng(0))
    np.testing.assert_array_equal(corrupted == 0, plain == 0)


def test_a_step_sees_the_corruption_of_its_schedule(monkeypatch):
    class Network:
        layers = ()

        def loss_and_gradients(self, x, corrupted, *_):
            self.seen = x, corrupted
            return 0.0, []

    network, stage = Network(), Stage(zeroed=(0.3, 0.6), rescaled=True)
    layerwise._step(network, X, stage, 0.1, np.random.default_rng(5), None, {})
    x, corrupted = network.seen
    assert x is X
    np.testing.assert_array_equal(
        corrupted, corrupt(X, (0.3, 0.6), True, np.random.default_rng(5))
    )


def test_a_range_beyond_one_is_refused():
    with pytest.raises(ValueError, match="expected a probability"):
        corrupt(X, (1.2, 1.5), False, np.random.default_rng(0))
