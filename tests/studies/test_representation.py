"""Projections on bones of constant length: exact lengths, standing feet."""

from data_synth import make_take
from numpy_cae.evaluation import position_error
from numpy_cae.manifold import starter
from numpy_cae.mocap import body_of
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.contacts import find_contacts
from studies.representation import _constrain, _sliding
from studies.shared.validity import bone_length_error


def test_constraints_keep_lengths_and_standing_feet():
    manifold = starter()
    truth, _ = manifold.features(body_of(make_take("walk", 99, 2.0, 30.0).motion))
    plain = manifold.project(truth, average_shifts=True)
    stands = find_contacts(features_to_positions(plain), manifold.rate)
    kept = _constrain(manifold, plain)
    assert bone_length_error(features_to_positions(kept), manifold.lengths) < 1e-9
    assert _sliding(kept, stands) < _sliding(plain, stands) / 5
    assert position_error(kept, truth) < 1.1 * position_error(plain, truth)
