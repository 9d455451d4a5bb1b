"""Equation 4 by hand, as written and as a matrix; and which hidden units it compares."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from data_synth import make_take
from numpy_cae.manifold import G, distance_matrix, hidden_units, signature

UNITS = st.integers(1, 6).flatmap(
    lambda frames: arrays(np.float64, (frames, 3), elements=st.floats(-1, 1))
)


@pytest.fixture(scope="module")
def features(untrained_manifold):
    return untrained_manifold.body(make_take("walk", 0, seconds=4.0, rate=30.0).motion).features


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


@pytest.mark.parametrize("frames", [1, 3, 4, 5, 120])
def test_every_frame_has_its_hidden_unit_and_no_other(untrained_manifold, features, frames):
    units = hidden_units(untrained_manifold, features[:frames])
    assert units.shape == (-(-frames // 4), 8)
    assert np.all(np.abs(units) <= 1)


def test_inside_a_long_clip_the_hidden_units_are_those_of_the_network(untrained_manifold, features):
    units = hidden_units(untrained_manifold, features)
    bare = untrained_manifold.network.encode(untrained_manifold.normalise(features)[None])[0]
    inside = slice(7, -7)
    assert len(units[inside]) > 0
    np.testing.assert_allclose(units[inside], bare[inside], atol=1e-5)
    assert np.abs(units[0] - bare[0]).max() > 1e-3


def test_the_hidden_units_of_a_still_clip_do_not_depend_on_its_length(untrained_manifold, features):
    still = np.repeat(features[:1], 50, axis=0)
    one, two = (hidden_units(untrained_manifold, still[:frames]) for frames in (3, 50))
    np.testing.assert_allclose(two, np.repeat(one, len(two), axis=0), atol=1e-5)
    with pytest.raises(ValueError, match="no frames"):
        hidden_units(untrained_manifold, still[:0])
