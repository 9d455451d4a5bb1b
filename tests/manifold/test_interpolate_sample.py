"""Interpolation meets its ends, and samples come from the stated priors."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.manifold import NeighbourPrior, interpolate, sample
from numpy_cae.manifold.interpolate import TRANSITION, shares
from numpy_cae.manifold.sample import NEIGHBOURS, encode_windows


@pytest.fixture(scope="module")
def features(walk_manifold):
    kinds = ("walk", "press_ups", "run", "walk", "press_ups", "run")
    motions = [make_take(kind, seed, 4.0, 30.0).motion for seed, kind in enumerate(kinds)]
    return [walk_manifold.body(motion).features for motion in motions]


@pytest.mark.parametrize("frames", [1, 13, 70])
def test_encode_and_decode_are_the_two_halves_of_project(walk_manifold, features, frames):
    clip = features[0][:frames]
    y = walk_manifold.encode(clip)
    assert np.abs(y).max() <= 1
    np.testing.assert_array_equal(walk_manifold.decode(y, frames), walk_manifold.project(clip))


@pytest.mark.parametrize(("share", "end"), [(0.0, 0), (1.0, 1), (0.3, None)])
def test_the_ends_are_the_projections(walk_manifold, features, share, end):
    pair = features[0][:50], features[1 if end is not None else 0][:50]
    between = interpolate(walk_manifold, *pair, share)
    np.testing.assert_allclose(between, walk_manifold.project(pair[end or 0]), atol=1e-5)


def test_a_transition_begins_as_the_first_and_ends_as_the_second(walk_manifold, features):
    one, other = features[0][:110], features[1][:110]
    between = interpolate(walk_manifold, one, other, TRANSITION)
    first, last = walk_manifold.project(one), walk_manifold.project(other)

    def distance(a, b, frames):
        return np.sqrt(np.mean((a - b)[frames] ** 2))

    begin, end = slice(0, 12), slice(-12, None)
    assert distance(between, first, begin) < 0.3 * distance(first, last, begin)
    assert distance(between, last, end) < 0.3 * distance(first, last, end)
    np.testing.assert_allclose(shares(TRANSITION, 5)[:, 0], [0, 0.25, 0.5, 0.75, 1])


def test_the_longer_motion_is_truncated(walk_manifold, features):
    between = interpolate(walk_manifold, features[0][:64], features[1][:37], 0.5)
    assert between.shape == (37, 63)
    same = interpolate(walk_manifold, features[0][:37], features[1][:90], 0.5)
    np.testing.assert_array_equal(between, same)


@pytest.mark.parametrize("share", [-0.1, 1.1, np.nan, "half"])
def test_an_invalid_share_is_refused(walk_manifold, features, share):
    with pytest.raises(ValueError, match="expected 0 to 1"):
        interpolate(walk_manifold, features[0], features[1], share)
    with pytest.raises(ValueError, match="no frames"):
        interpolate(walk_manifold, features[0][:0], features[1], 0.5)


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
    with pytest.raises(ValueError, match="window of 32 frames"):
        encode_windows(walk_manifold, [features[0][:20]])


@pytest.mark.parametrize("frames", [1, 20, 32, 100])
def test_samples_have_the_requested_length_and_repeat_by_seed(walk_manifold, features, frames):
    for prior in (None, NeighbourPrior(encode_windows(walk_manifold, features))):
        one, again, other = (
            sample(walk_manifold, frames, np.random.default_rng(seed), prior) for seed in (3, 3, 4)
        )
        assert one.shape == (frames, 63)
        np.testing.assert_array_equal(one, again)
        assert not np.array_equal(one, other)
    with pytest.raises(ValueError, match="expected 1 or more"):
        sample(walk_manifold, 0, np.random.default_rng(0))
