"""Blind projection: p as the motion itself tells it, and the mean over the pooling grid."""

from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.blind import lost_share, project_shifted
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import zero_values

RNG = np.random.default_rng(0)
X = RNG.normal(size=(3, 32, 63)).astype(np.float32) * 0.2
X[..., 0] = 0  # as the hips, which stand above their own place on the floor


@pytest.fixture(scope="module")
def network():
    return ConvAutoencoder(filters=(8, 9), taps=5, rng=np.random.default_rng(1))


@pytest.mark.parametrize("p", [0.1, 0.5, 0.9])
def test_the_share_of_zeros_is_p(p):
    lost = zero_values(X, p, np.random.default_rng(2))
    assert lost_share(lost).shape == (3, 1, 1)
    np.testing.assert_allclose(lost_share(lost), p, atol=0.04)


def test_what_is_zero_throughout_says_nothing_of_p():
    assert np.all(lost_share(X) == 0)
    wrist_absent = X.copy()
    wrist_absent[..., 30:33] = 0
    assert np.all(lost_share(wrist_absent) == 0)
    assert np.all(lost_share(0 * X) == 0)


def test_each_window_has_a_share_of_its_own():
    lost = X.copy()
    lost[1, ::2] = 0
    np.testing.assert_allclose(lost_share(lost)[:, 0, 0], [0, 0.5, 0])


def test_one_shift_is_projection_and_all_do_not_care_where_the_grid_lies(network):
    np.testing.assert_allclose(project_shifted(network, X), network.project(X), atol=1e-6)
    middle = np.zeros((1, 96, 63), np.float32)
    middle[:, 32:64] = X[:1]
    later = np.roll(middle, 1, axis=1)
    unit = network.frames_per_unit
    for shifts, same in ((1, False), (unit, True)):
        moved = project_shifted(network, later, shifts)[:, 9:88]
        still = project_shifted(network, middle, shifts)[:, 8:87]
        assert np.allclose(moved, still, atol=1e-5) == same


def test_windows_are_projected_in_parts_as_at_once(network, monkeypatch):
    whole = project_shifted(network, X, 4)
    monkeypatch.setattr("numpy_cae.manifold.blind.AT_ONCE", 2)
    np.testing.assert_allclose(project_shifted(network, X, 4), whole, atol=1e-6)


def test_only_a_network_that_learned_so_is_given_rescaled_input(network):
    plain = MotionManifold(network, np.zeros(63), np.ones(63), np.ones(20))
    taught = replace(plain, settings={"schedule": {"fine_tuning": {"rescaled": True}}})
    lost = zero_values(X, 0.5, np.random.default_rng(3))
    given = lost / (1 - lost_share(lost))
    assert not plain.rescales
    np.testing.assert_allclose(plain.project_windows(lost), network.project(lost), atol=1e-6)
    np.testing.assert_allclose(taught.project_windows(lost), network.project(given), atol=1e-6)
    np.testing.assert_allclose(taught.project_windows(X), network.project(X), atol=1e-6)
    # A clip of any length takes the same way.
    clip = zero_values(X[0, :29], 0.5, np.random.default_rng(4))
    by_hand = plain.project(clip / (1 - lost_share(clip[None])[0]), shifts=4)
    np.testing.assert_allclose(taught.project(clip, shifts=4), by_hand, atol=1e-5)
