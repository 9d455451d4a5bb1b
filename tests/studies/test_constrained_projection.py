"""Optimised projections: exact lengths, standing feet."""

from data_synth import make_take
from numpy_cae.evaluation import position_error
from numpy_cae.manifold import starter
from numpy_cae.mocap import body_of
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.contacts import find_contacts
from studies.constraints import constraints
from studies.constraints.constrained import project_constrained


def test_constrained_projection_keeps_lengths_and_standing_feet():
    manifold, walk = starter(), make_take("walk", 99, 2.0, 30.0).motion
    features, start = manifold.features(body_of(walk))
    plain = manifold.project(features)
    contacts = find_contacts(features_to_positions(features, start), 30.0)
    assert 0.2 < contacts.mean() < 0.95
    kept = project_constrained(manifold, features, start, contacts, steps=60)
    assert constraints.bone_length_error(kept, manifold.lengths)[0] < 1e-20
    moved = constraints.foot_sliding_error(plain, contacts)[0]
    assert constraints.foot_sliding_error(kept, contacts)[0] < moved / 5**2
    assert position_error(kept, features) < 1.1 * position_error(plain, features)
