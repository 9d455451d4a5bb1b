"""What hidden units are used for: interpolation, samples of a prior, and equation 4."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from data_synth import make_take
from numpy_cae.manifold import (
    G,
    NeighbourPrior,
    distance_matrix,
    hidden_units,
    interpolate,
    sample,
    signature,
)
from numpy_cae.manifold.interpolation import TRANSITION, shares
from numpy_cae.manifold.sampling import NEIGHBOURS, encode_windows
from numpy_cae.mocap import body_of

UNITS = st.integers(1, 6).flatmap(
    lambda frames: arrays(np.float64, (frames, 3), elements=st.floats(-1, 1))
)


@pytest.fixture(scope="module")
def features(walk_manifold):
    actions = ("walk", "press_ups", "run", "walk", "press_ups", "run")
    motions = [make_take(action, seed, 4.0, 30.0).motion for seed, action in enumerate(actions)]
    return [walk_manifold.features(body_of(motion))[0] for motion in motions]


@pytest.mark.parametrize("frames", [1, 13, 70])
def test_encode_and_decode_are_the_two_halves_of_project(walk_manifold, features, frames):
    clip = features[0][:frames]
    y = walk_manifold.encode(clip)
    assert np.abs(y).max() <= 1
    np.testing.assert_array_equal(walk_manifold.decode(y, frames), walk_manifold.project(clip))


@pytest.mark.parametrize(
    ("share", "second", "expected"), [(0.0, 1, 0), (1.0, 1, 1), (0.3, 0, 0), (0.7, 3, None)]
)
def test_the_ends_are_the_projections_and_the_longer_motion_is_truncated(
    walk_manifold, features, share, second, expected
):
    x_0 = features[0][:50]
    x_1 = features[second][:50]
    between = interpolate(walk_manifold, x_0, x_1, share)
    if expected is not None:
        expected = walk_manifold.project(features[expected][:50])
        np.testing.assert_allclose(between, expected, atol=1e-5)
    for pair in ((x_0, features[second]), (features[0], x_1)):
        np.testing.assert_array_equal(interpolate(walk_manifold, *pair, share), between)


def test_a_transition_begins_as_the_first_and_ends_as_the_second(walk_manifold, features):
    x_0 = features[0][:110]
    x_1 = features[1][:110]
    between = interpolate(walk_manifold, x_0, x_1, TRANSITION)
    first = walk_manifold.project(x_0)
    last = walk_manifold.project(x_1)

    def distance(a, b, frames):
        return np.sqrt(np.mean((a - b)[frames] ** 2))

    begin = slice(0, 12)
    end = slice(-12, None)
    assert distance(between, first, begin) < 0.3 * distance(first, last, begin)
    assert distance(between, last, end) < 0.3 * distance(first, last, end)
    np.testing.assert_allclose(shares(TRANSITION, 5)[:, 0], [0, 0.25, 0.5, 0.75, 1])


def test_the_fitted_prior_stays_between_windows(walk_manifold, features):
    encoded = encode_windows(walk_manifold, features)
    assert encoded.shape[1:] == (8, 24)
    assert NEIGHBOURS < len(encoded)
    y = NeighbourPrior(encoded).draw(8, np.random.default_rng(1))
    assert y.shape == (8, 24)
    assert np.all(y <= encoded.max(axis=0) + 1e-6)
    assert np.all(y >= encoded.min(axis=0) - 1e-6)
    few = NeighbourPrior(encoded[:1])
    np.testing.assert_allclose(few.draw(8, np.random.default_rng(0)), encoded[0], atol=1e-6)


@pytest.mark.parametrize("frames", [1, 20, 32, 100])
def test_samples_have_the_requested_length_and_repeat_by_seed(walk_manifold, features, frames):
    for prior in (None, NeighbourPrior(encode_windows(walk_manifold, features))):
        first, again, second = (
            sample(walk_manifold, frames, np.random.default_rng(seed), prior) for seed in (3, 3, 4)
        )
        assert first.shape == (frames, 63)
        np.testing.assert_array_equal(first, again)
        assert not np.array_equal(first, second)


@given(st.lists(UNITS, min_size=2, max_size=4), st.lists(UNITS, min_size=1, max_size=3))
def test_the_matrix_is_equation_4_of_each_pair(rows, columns):
    matrix = distance_matrix([signature(u) for u in rows], [signature(u) for u in columns])
    square = distance_matrix([signature(u) for u in rows])
    for i, a in enumerate(rows):
        np.testing.assert_allclose(matrix[i], [G(a, b) for b in columns], atol=1e-12)
        np.testing.assert_allclose(square[i], [G(a, b) for b in rows], atol=1e-12)


@pytest.mark.parametrize("frames", [1, 3, 4, 5, 120])
def test_the_hidden_units_of_a_still_clip_do_not_depend_on_its_length(
    walk_manifold, features, frames
):
    still = np.repeat(features[0][:1], frames, axis=0)
    units = hidden_units(walk_manifold, still)
    assert units.shape == (-(-frames // 4), 24)
    first = hidden_units(walk_manifold, still[:1])
    np.testing.assert_allclose(units, np.repeat(first, len(units), axis=0), atol=1e-5)


def test_inside_a_long_clip_the_hidden_units_are_those_of_the_network(walk_manifold, features):
    units = hidden_units(walk_manifold, features[0])
    bare = walk_manifold.network.encode(walk_manifold.normalise(features[0])[None])[0]
    assert len(units) == 30 and np.all(np.abs(units) <= 1)
    np.testing.assert_allclose(units[7:-7], bare[7:-7], atol=1e-5)
    assert np.abs(units[0] - bare[0]).max() > 1e-3


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda manifold, clip: interpolate(manifold, clip[:0], clip, 0.5), "no frames"),
        (lambda manifold, clip: interpolate(manifold, clip, clip, np.nan), "expected 0 to 1"),
        (lambda manifold, clip: hidden_units(manifold, clip[:0]), "no frames"),
        (lambda manifold, clip: encode_windows(manifold, [clip[:20]]), "window of 32 frames"),
        (lambda manifold, clip: sample(manifold, 0, None), "expected 1 or more"),
    ],
)
def test_too_few_frames_and_an_invalid_share_are_refused(walk_manifold, features, use, message):
    with pytest.raises(ValueError, match=message):
        use(walk_manifold, features[0])
