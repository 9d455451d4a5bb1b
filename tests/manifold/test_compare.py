"""Equation 4: worked out by hand, as written and as a matrix; and which hidden units count."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from data_synth import make_take
from numpy_cae.manifold import G, MotionManifold, distance_matrix, hidden_units, signature
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import body_of, bone_lengths

UNITS = st.integers(1, 6).flatmap(
    lambda frames: arrays(np.float64, (frames, 3), elements=st.floats(-1, 1))
)


@pytest.fixture(scope="module")
def body():
    return body_of(make_take("walk", 0, seconds=4.0, rate=30.0).motion)


@pytest.fixture(scope="module")
def manifold(body):
    network = ConvAutoencoder(filters=(8, 12, 16), rng=np.random.default_rng(1))
    bare = MotionManifold(network, np.zeros(63), np.ones(63), bone_lengths(body))
    bare.mean_pose = bare.features(body)[0].mean(axis=0)
    return bare


def test_equation_4_by_hand():
    one = np.array([[0.5, -1.0], [1.0, 0.0]])
    two = np.array([[0.0, 0.0], [0.25, 0.5], [0.5, 1.0]])
    # max: (1, 0) and (0.5, 1); min: (0.5, -1) and (0, 0).
    assert G(one, two) == pytest.approx((0.25 + 1.0) + (0.25 + 1.0))
    np.testing.assert_array_equal(signature(one), [1.0, 0.0, 0.5, -1.0])


@given(st.lists(UNITS, min_size=2, max_size=4), st.lists(UNITS, min_size=1, max_size=3))
def test_the_matrix_is_equation_4_of_each_pair(some, others):
    matrix = distance_matrix([signature(u) for u in some], [signature(u) for u in others])
    np.testing.assert_allclose(matrix, [[G(a, b) for b in others] for a in some], atol=1e-12)
    square = distance_matrix([signature(u) for u in some])
    np.testing.assert_allclose(square, [[G(a, b) for b in some] for a in some], atol=1e-12)


@given(UNITS, st.randoms(use_true_random=False))
def test_when_something_happens_does_not_matter(units, random):
    order = list(range(len(units)))
    random.shuffle(order)
    assert G(units, units[order]) == 0
    assert G(units, np.repeat(units, 2, axis=0)) == 0


@pytest.mark.parametrize("frames", [1, 7, 8, 9, 120])
def test_every_frame_has_its_hidden_unit_and_no_other(manifold, body, frames):
    features = manifold.features(body)[0][:frames]
    units = hidden_units(manifold, features)
    assert units.shape == (-(-frames // 8), 16)
    assert np.all(np.abs(units) <= 1)


def test_inside_a_long_clip_the_hidden_units_are_those_of_the_network(manifold, body):
    features = manifold.features(body)[0]
    units = hidden_units(manifold, features)
    bare = manifold.network.encode(manifold.normalise(features)[None])[0]
    inside = slice(7, -7)
    assert len(units[inside]) > 0
    np.testing.assert_allclose(units[inside], bare[inside], atol=1e-5)
    assert np.abs(units[0] - bare[0]).max() > 1e-3


def test_a_still_clip_looks_the_same_however_long_it_is(manifold, body):
    still = np.repeat(manifold.features(body)[0][:1], 50, axis=0)
    one, two = (hidden_units(manifold, still[:frames]) for frames in (3, 50))
    np.testing.assert_allclose(two, np.repeat(one, len(two), axis=0), atol=1e-5)


def test_no_frames_no_hidden_units(manifold):
    with pytest.raises(ValueError, match="no frames"):
        hidden_units(manifold, np.zeros((0, 63)))
