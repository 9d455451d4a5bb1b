"""Projection with the mask unknown: the share of lost values, and the mean over the grid."""

from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.completion import project_shifted, zeroed_fraction
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import zero_values

X = np.random.default_rng(0).normal(size=(3, 32, 63)).astype(np.float32) * 0.2
X[..., 0] = 0  # as the hips' x in the body's frame


@pytest.fixture(scope="module")
def network():
    return ConvAutoencoder(filters=(8, 9), taps=5, rng=np.random.default_rng(1))


@pytest.mark.parametrize("p", [0.0, 0.1, 0.5, 0.9])
def test_the_share_of_zeros_is_p_without_features_that_are_always_zero(p):
    for x in (X, X * (np.arange(63) // 3 != 10)):  # in the second a wrist is absent
        share = zeroed_fraction(zero_values(x, p, np.random.default_rng(2)))
        assert share.shape == (3, 1, 1)
        np.testing.assert_allclose(share, p, atol=0.04 * (p > 0))
    assert np.all(zeroed_fraction(0 * X) == 0)


def test_one_shift_is_projection_and_all_shifts_commute_with_a_shift(network):
    np.testing.assert_allclose(project_shifted(network, X), network.project(X), atol=1e-6)
    middle = np.zeros((1, 96, 63), np.float32)
    middle[:, 32:64] = X[:1]
    for average, same in ((False, False), (True, True)):
        moved = project_shifted(network, np.roll(middle, 1, axis=1), average)[:, 9:88]
        still = project_shifted(network, middle, average)[:, 8:87]
        assert np.allclose(moved, still, atol=1e-5) == same


def test_only_a_network_trained_on_rescaled_input_is_given_it(network):
    plain = MotionManifold(network, np.zeros(63), np.ones(63), np.ones(20))
    rescaling = replace(plain, rescales=True)
    lost = zero_values(X, 0.5, np.random.default_rng(3))
    rescaled = lost / (1 - zeroed_fraction(lost))
    np.testing.assert_allclose(plain.project_windows(lost), network.project(lost), atol=1e-6)
    np.testing.assert_allclose(
        rescaling.project_windows(lost), network.project(rescaled), atol=1e-6
    )
    np.testing.assert_allclose(rescaling.project_windows(X), network.project(X), atol=1e-6)
    clip = zero_values(X[0, :29], 0.5, np.random.default_rng(4))
    by_hand = plain.project(clip / (1 - zeroed_fraction(clip[None])[0]), average_shifts=True)
    np.testing.assert_allclose(rescaling.project(clip, average_shifts=True), by_hand, atol=1e-5)
