"""Optimised projections: exact lengths, standing feet, pinned joints."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.beyond import Pins, constrain, constraints, project_constrained
from numpy_cae.evaluation import position_error
from numpy_cae.manifold import Repaired, learn_manifold
from numpy_cae.motion import (
    JOINTS,
    body_of,
    body_positions,
    features_to_positions,
    load_motion,
    retarget,
    write_bvh,
)
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.training import Schedule, Stage


@pytest.fixture(scope="module")
def walked():
    """A manifold of walks, and the features and root of one that it was not trained on."""
    takes = [body_of(make_take("walk", seed=seed, seconds=6, rate=30).motion) for seed in range(6)]
    schedule = Schedule(Stage(4, 0.5, 0.9, 0.0), Stage(6, 0.1, 0.9, 0.0))
    manifold = learn_manifold(takes[1:], schedule, 0, 64, 32, (16, 24), show_progress=False)
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
    targets, weights = np.full(plain.shape, np.nan), np.zeros(plain.shape)
    targets[30, hand], weights[30, hand] = plain[30, hand] + [0.0, 0.1, 0.05], 1.0
    kept = project_constrained(
        manifold, features, start, pins=Pins(targets, weights, np.eye(20)), steps=60
    )
    reached = features_to_positions(kept, start)[30, hand]
    assert np.linalg.norm(reached - targets[30, hand]) < 0.03


def test_feet_of_a_repaired_motion_stand_where_those_of_the_file_do(walked, tmp_path):
    """Both legs drift for a while. The left one is damaged; the right one is right in the file."""
    motion = make_take("waiting", 1, seconds=2.0, rate=60.0).motion
    own = body_positions(motion)
    touched = np.zeros((len(motion), 20), dtype=bool)
    touched[40:80, [13, 14, 15, 17, 18, 19]] = True
    drift = 0.05 * np.sin(np.pi * (np.arange(len(motion)) - 40) / 40)
    drifting = own + drift[:, None, None] * [1, 0, 1]
    drifted = retarget(motion, drifting, touched=touched)
    repaired = Repaired(drifted, touched & (np.arange(20) < 16), np.zeros(touched.shape))
    kept = constrain(motion, repaired, walked[0])
    write_bvh(kept.motion, tmp_path / "kept.bvh")
    written = body_positions(load_motion(tmp_path / "kept.bvh"))
    stands = find_contacts(own, 60.0)
    stands = stands[1:] & stands[:-1]
    assert stands[40:80].mean() > 0.5
    slides, slid = (
        np.linalg.norm(np.diff(each[:, FEET], axis=0), axis=-1)[stands] for each in (written, own)
    )
    assert slides.max() < slid.max() + 1e-5
    right = stands[:, 1]
    np.testing.assert_allclose(written[1:, 18:][right], own[1:, 18:][right], atol=1e-5)
    np.testing.assert_allclose(written[:, 0], own[:, 0], atol=1e-5)


def test_a_motion_whose_feet_stand_is_the_same_to_the_bit(walked):
    motion = make_take("walk", 9, seconds=2.0, rate=60.0).motion
    nothing = np.zeros((len(motion), 20), dtype=bool)
    kept = constrain(motion, Repaired(motion, nothing, nothing.astype(float)), walked[0])
    np.testing.assert_array_equal(kept.motion.rotations, motion.rotations)
    assert not kept.touched.any()
