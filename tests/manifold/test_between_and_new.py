"""Interpolation has its ends where they belong, and priors give what they are said to."""

from __future__ import annotations

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.manifold import NeighbourPrior, interpolate, learn_manifold, sample
from numpy_cae.manifold.interpolate import TRANSITION, shares
from numpy_cae.manifold.sample import NEIGHBOURS, draw_uniform, encode_windows
from numpy_cae.motion import body_of
from numpy_cae.training import Schedule, Stage


@pytest.fixture(scope="module")
def learned():
    kinds = ("walk", "press_ups", "run")
    takes = [body_of(make_take(kinds[s % 3], s, seconds=4.0, rate=30.0).motion) for s in range(6)]
    quick = Schedule(layer=Stage(epochs=2), fine_tuning=Stage(3, 0.05, 0.9, 0.0))
    manifold = learn_manifold(
        takes, quick, window=32, overlap=16, filters=(12, 16), taps=5, show_progress=False
    )
    return manifold, [manifold.features(take)[0] for take in takes]


def test_encode_and_decode_are_the_two_halves_of_project(learned):
    manifold, features = learned
    for frames in (1, 13, 70):
        clip = features[0][:frames]
        y = manifold.encode(clip)
        assert np.abs(y).max() <= 1
        np.testing.assert_array_equal(manifold.decode(y, frames), manifold.project(clip))


@pytest.mark.parametrize(("share", "end"), [(0.0, 0), (1.0, 1)])
def test_the_ends_are_the_projections(learned, share, end):
    manifold, features = learned
    pair = features[0][:50], features[1][:50]
    between = interpolate(manifold, *pair, share)
    np.testing.assert_allclose(between, manifold.project(pair[end]), atol=1e-5)


def test_between_a_motion_and_itself_is_its_projection(learned):
    manifold, features = learned
    clip = features[2][:41]
    between = interpolate(manifold, clip, clip, 0.3)
    np.testing.assert_allclose(between, manifold.project(clip), atol=1e-5)


def test_a_transition_begins_as_the_one_and_ends_as_the_other(learned):
    manifold, features = learned
    one, other = features[0][:110], features[1][:110]
    between = interpolate(manifold, one, other, TRANSITION)
    first, last = manifold.project(one), manifold.project(other)

    def apart(a, b, frames):
        return np.sqrt(np.mean((a - b)[frames] ** 2))

    begin, end = slice(0, 12), slice(-12, None)
    assert apart(between, first, begin) < 0.3 * apart(first, last, begin)
    assert apart(between, last, end) < 0.3 * apart(first, last, end)


def test_the_longer_motion_is_cut(learned):
    manifold, features = learned
    between = interpolate(manifold, features[0][:64], features[1][:37], 0.5)
    assert between.shape == (37, 63)
    same = interpolate(manifold, features[0][:37], features[1][:90], 0.5)
    np.testing.assert_array_equal(between, same)


@pytest.mark.parametrize("share", [-0.1, 1.1, np.nan, "half"])
def test_a_share_that_makes_no_sense_is_refused(learned, share):
    manifold, features = learned
    with pytest.raises(ValueError, match="expected 0 to 1"):
        interpolate(manifold, features[0], features[1], share)
    with pytest.raises(ValueError, match="no frames"):
        interpolate(manifold, features[0][:0], features[1], 0.5)


def test_shares_of_a_transition_grow_from_0_to_1():
    np.testing.assert_allclose(shares(TRANSITION, 5)[:, 0], [0, 0.25, 0.5, 0.75, 1])
    np.testing.assert_array_equal(shares(0.25, 3), np.full((3, 1), 0.25))


def test_the_uniform_prior_fills_the_whole_space():
    y = draw_uniform(200, 50, np.random.default_rng(0))
    assert np.abs(y).max() <= 1
    assert np.std(y) == pytest.approx(1 / np.sqrt(3), rel=0.02)


def test_the_fitted_prior_stays_between_windows(learned):
    manifold, features = learned
    encoded = encode_windows(manifold, features)
    assert encoded.shape[1:] == (8, 16)
    prior = NeighbourPrior(encoded)
    y = prior.draw(8, np.random.default_rng(1))
    assert y.shape == (8, 16)
    assert np.all(y <= encoded.max(axis=0))
    assert np.all(y >= encoded.min(axis=0))
    few = NeighbourPrior(encoded[:1])
    np.testing.assert_allclose(few.draw(8, np.random.default_rng(0)), encoded[0], atol=1e-6)
    assert NEIGHBOURS < len(encoded)


@pytest.mark.parametrize("frames", [1, 20, 32, 100])
def test_samples_are_as_long_as_asked_and_repeat_by_seed(learned, frames):
    manifold, features = learned
    for prior in (None, NeighbourPrior(encode_windows(manifold, features))):
        one, again, other = (
            sample(manifold, frames, np.random.default_rng(seed), prior) for seed in (3, 3, 4)
        )
        assert one.shape == (frames, 63)
        np.testing.assert_array_equal(one, again)
        assert not np.array_equal(one, other)


def test_a_prior_needs_a_whole_window_and_a_sample_frames(learned):
    manifold, features = learned
    with pytest.raises(ValueError, match="window of 32 frames"):
        encode_windows(manifold, [features[0][:20]])
    with pytest.raises(ValueError, match="expected 1 or more"):
        sample(manifold, 0, np.random.default_rng(0))
