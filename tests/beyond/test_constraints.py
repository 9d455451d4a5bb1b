"""Each constraint's pullback is its derivative, and each is zero where nothing is wrong."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.beyond import constraints
from numpy_cae.beyond.exact_lengths import exact_lengths
from numpy_cae.motion import JOINTS, RootTransform, features_to_positions
from numpy_cae.verify import check_gradients

SEEDS = st.integers(0, 2**32 - 1)


def drawn(seed, frames=5):
    rng = np.random.default_rng(seed)
    return rng, rng.normal(scale=0.5, size=(frames, 63))


@settings(max_examples=15)
@given(seed=SEEDS)
def test_bone_lengths(seed):
    rng, features = drawn(seed)
    lengths = rng.uniform(0.1, 0.5, size=20)
    check_gradients(lambda f: constraints.bone_length_error(f, lengths), features, rng=rng)


@settings(max_examples=15)
@given(seed=SEEDS)
def test_feet(seed):
    rng, features = drawn(seed)
    contacts = rng.random((5, 2)) < 0.8
    check_gradients(lambda f: constraints.foot_sliding_error(f, contacts), features, rng=rng)


@settings(max_examples=15)
@given(seed=SEEDS)
def test_ground(seed):
    rng, features = drawn(seed)
    check_gradients(lambda f: constraints.ground_penetration(f, 0.1), features, rng=rng)


@settings(max_examples=15)
@given(seed=SEEDS)
def test_wanted_features(seed):
    rng, features = drawn(seed)
    wanted, weights = rng.normal(size=(5, 63)), rng.uniform(size=(5, 63))
    check_gradients(lambda f: constraints.squared_difference(f, wanted, weights), features, rng=rng)


@settings(max_examples=15)
@given(seed=SEEDS)
def test_places_in_the_world(seed):
    rng, features = drawn(seed)
    targets = rng.normal(size=(5, 20, 3))
    weights = rng.uniform(size=(5, 20)) * (rng.random((5, 20)) < 0.5)
    start, body = RootTransform(*rng.normal(size=3)), rng.normal(size=(20, 20))
    for asked in ((weights,), (rng.uniform(size=(5, 20, 3)), body)):
        check_gradients(
            lambda f, asked=asked: constraints.pin_error(f, start, targets, *asked),
            features,
            rng=rng,
        )


@given(seed=SEEDS)
def test_a_motion_is_where_it_is(seed):
    rng, features = drawn(seed)
    start = RootTransform(*rng.normal(size=3))
    positions = features_to_positions(features, start)
    loss, _ = constraints.pin_error(features, start, positions, np.ones((5, 20)))
    assert loss < 1e-25


@given(seed=SEEDS)
def test_how_far_feet_get_is_how_far_they_get_in_the_world(seed):
    _, features = drawn(seed)
    contacts = np.ones((5, 2), bool)
    toes = [JOINTS.index("left_toe"), JOINTS.index("right_toe")]
    steps = np.diff(features_to_positions(features)[:, toes][..., [0, 2]], axis=0)
    loss, _ = constraints.foot_sliding_error(features, contacts)
    np.testing.assert_allclose(loss, np.mean(np.sum(steps**2, axis=-1)), rtol=1e-9)


@settings(max_examples=15)
@given(seed=SEEDS)
def test_exact_lengths_are_exact_and_their_pullback_is_right(seed):
    rng, features = drawn(seed, frames=3)
    lengths = rng.uniform(0.1, 0.5, size=20)
    exact, _ = exact_lengths(features, lengths)
    loss, _ = constraints.bone_length_error(exact, lengths)
    assert loss < 1e-28
    check_gradients(lambda f: exact_lengths(f, lengths), features, rng=rng)
