"""Each constraint's pullback is its derivative, and its loss is that of the world."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.motion import JOINTS, features_to_positions
from numpy_cae.verify import check_gradients
from studies.constraints import constraints
from studies.constraints.exact_lengths import exact_lengths

SEEDS = st.integers(0, 2**32 - 1)


def drawn(seed, frames=5):
    rng = np.random.default_rng(seed)
    return rng, rng.normal(scale=0.5, size=(frames, 63))


def losses(rng):
    """Each loss of features (5, 63), with random arguments."""
    lengths, contacts = rng.uniform(0.1, 0.5, size=20), rng.random((5, 2)) < 0.8
    target = rng.normal(size=(5, 63))
    return {
        "bones": lambda f: constraints.bone_length_error(f, lengths),
        "feet": lambda f: constraints.foot_sliding_error(f, contacts),
        "ground": lambda f: constraints.ground_penetration(f, 0.1),
        "difference": lambda f: constraints.squared_difference(f, target),
    }


@settings(max_examples=60)
@given(seed=SEEDS, name=st.sampled_from(list(losses(np.random.default_rng(0)))))
def test_each_pullback_is_the_derivative(seed, name):
    rng, features = drawn(seed)
    check_gradients(losses(rng)[name], features, rng=rng)


@given(seed=SEEDS)
def test_foot_sliding_is_measured_as_in_the_world(seed):
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
