"""Optimised projections: exact lengths, standing feet."""

import pytest

from data_synth import make_take
from numpy_cae.beyond import constraints, project_constrained
from numpy_cae.evaluation import position_error
from numpy_cae.manifold import learn_manifold
from numpy_cae.motion import body_of, features_to_positions
from numpy_cae.motion.contacts import find_contacts
from numpy_cae.training import Schedule, Stage


@pytest.fixture(scope="module")
def walked():
    """A manifold of walks, and the features and root of one that it was not trained on."""
    takes = [body_of(make_take("walk", seed=seed, seconds=6, rate=30).motion) for seed in range(6)]
    schedule = Schedule(
        Stage(epochs=4, rate=0.5, alpha=0.0),
        Stage(epochs=6, rate=0.1, alpha=0.0),
    )
    manifold = learn_manifold(takes[1:], schedule, 0, 64, 32, (16, 24))
    features, start = manifold.features(takes[0][:70])
    return manifold, features, start


def test_constrained_projection_keeps_lengths_and_standing_feet(walked):
    manifold, features, start = walked
    plain = manifold.project(features)
    contacts = find_contacts(features_to_positions(features, start), 30.0)
    assert 0.2 < contacts.mean() < 0.95
    kept = project_constrained(manifold, features, start, contacts, steps=60)
    assert constraints.bone_length_error(kept, manifold.lengths)[0] < 1e-20
    moved = constraints.foot_sliding_error(plain, contacts)[0]
    assert constraints.foot_sliding_error(kept, contacts)[0] < moved / 5**2
    assert position_error(kept, features) < 1.1 * position_error(plain, features)
