"""Missing joints and unknown rotations predicted from the joints that are visible."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from data_synth import make_take
from numpy_cae.cleanup.interpolation import mark_unknown_channels
from numpy_cae.cleanup.joint_regression import (
    blend_rotations,
    mean_rotation,
    regress_positions,
    regress_rotations,
    visible_positions,
)
from numpy_cae.mocap import body_positions
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion import JOINTS, bone_lengths
from numpy_cae.motion.features import local_positions
from numpy_cae.motion.joints import LIMBS, joint_mask
from numpy_cae.motion.quaternions import from_vector, slerp


@pytest.fixture(scope="module")
def walk():
    return make_take("walk", 0, seconds=6.0, rate=30.0).motion


def body_in(motion):
    return Body(motion, bone_lengths(body_positions(motion)))


def regressed_leg(motion, hole):
    missing = joint_mask(len(motion), LIMBS["left_leg"], hole)
    unknown, _ = mark_unknown_channels(motion, missing)
    return missing, list(regress_rotations(body_in(motion), unknown, missing))


def test_a_leg_of_a_walk_is_predicted_within_centimetres(walk):
    missing, regressed = regressed_leg(walk, slice(60, 105))
    filled = blend_rotations(walk, regressed, lambda *_: 1.0)
    off = np.linalg.norm(body_positions(filled) - body_positions(walk), axis=-1)
    stride = np.ptp(body_positions(walk)[60:105, JOINTS.index("left_ankle"), 2])
    assert off[missing].mean() < 0.05 * stride
    assert_allclose(off[~missing], 0.0, atol=1e-9)


def test_the_share_leads_from_the_start_to_the_prediction(walk):
    hole = slice(60, 80)
    _, regressed = regressed_leg(walk, hole)
    half = blend_rotations(walk, regressed, lambda *_: 0.5)
    (_, columns, predicted), *_ = regressed
    expected = slerp(walk.rotations[hole, columns], predicted, np.array(0.5))
    assert_allclose(half.rotations[hole, columns], expected)


def test_some_frames_of_a_motion_are_blended_as_all_are(walk):
    hole = slice(60, 80)
    missing, regressed = regressed_leg(walk, hole)
    every = blend_rotations(walk, regressed, lambda *_: 0.7)
    in_holes = missing.any(axis=1)
    some = blend_rotations(walk.at(in_holes), regressed, lambda *_: 0.7, in_holes)
    assert_array_equal(some.rotations, every.rotations[in_holes])


def test_without_the_hips_nothing_is_predicted(walk):
    missing = joint_mask(len(walk), ["hips", *LIMBS["left_leg"]], slice(60, 80))
    unknown, _ = mark_unknown_channels(walk, missing)
    assert list(regress_rotations(body_in(walk), unknown, missing)) == []


def test_the_body_is_seen_from_its_own_place_and_heading(walk):
    positions = body_positions(walk)
    is_visible = np.ones(len(JOINTS), bool)
    turned = positions @ np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    here = visible_positions(positions, is_visible, 30.0)
    there = visible_positions(turned + [3.0, 0.0, -2.0], is_visible, 30.0)
    assert_allclose(there, here, atol=1e-9)


def test_the_mean_of_rotations_ignores_their_signs():
    vectors = np.array([-0.3, 0.1, 0.5])[:, None, None] * [1.0, 0.0, 0.0]
    rotations = from_vector(vectors)
    rotations[1] *= -1
    assert_allclose(mean_rotation(rotations)[0], from_vector(np.array([0.1, 0.0, 0.0])), atol=1e-3)


def test_positions_of_an_arm_are_predicted_within_centimetres(walk):
    body = body_in(walk)
    missing = joint_mask(len(walk), LIMBS["right_arm"], slice(60, 105))
    hidden = body.features.copy()
    local_positions(hidden)[missing] = 9.0  # what a file has in a hole is ignored
    off = local_positions(regress_positions(hidden, missing) - body.features)
    assert np.linalg.norm(off[missing], axis=-1).mean() < 0.03
    assert not off[~missing].any()


def test_a_joint_that_is_never_visible_stays_where_it_is(walk):
    features = body_in(walk).features
    missing = joint_mask(len(walk), ["left_wrist"], slice(None))
    assert_array_equal(regress_positions(features, missing), features)
