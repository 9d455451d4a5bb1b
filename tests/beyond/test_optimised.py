"""Optimised projections: exact lengths, standing feet, pinned joints."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.beyond import Pins, constraints, project_constrained
from numpy_cae.manifold import learn_manifold
from numpy_cae.measures import position_error
from numpy_cae.motion import JOINTS, body_of, features_to_positions
from numpy_cae.motion.contacts import find_contacts
from numpy_cae.training import Schedule, Stage


@pytest.fixture(scope="module")
def walked():
    """A manifold of walks, and the features and root of one that it was not trained on."""
    takes = [body_of(make_take("walk", seed=seed, seconds=6, rate=30).motion) for seed in range(6)]
    schedule = Schedule(Stage(4, 0.5, 0.9, 0.0), Stage(6, 0.1, 0.9, 0.0))
    manifold = learn_manifold(
        takes[1:], schedule, filters=(16, 24), window=64, overlap=32, show_progress=False
    )
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


def test_a_pinned_hand_reaches_its_target(walked):
    manifold, features, start = walked
    hand = JOINTS.index("left_wrist")
    plain = features_to_positions(manifold.project(features), start)
    targets, weights = np.full(plain.shape, np.nan), np.zeros(plain.shape[:2])
    targets[30, hand], weights[30, hand] = plain[30, hand] + [0.0, 0.1, 0.05], 1.0
    kept = project_constrained(manifold, features, start, pins=Pins(targets, weights), steps=60)
    reached = features_to_positions(kept, start)[30, hand]
    assert np.linalg.norm(reached - targets[30, hand]) < 0.03
