"""Curves over holes, what is unknown there, and the curve and strength that a motion chooses."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cleanup.holes import (
    POWERS,
    PRIOR_TRIALS,
    STRENGTHS,
    choose_candidates,
    correct_features,
    place_trials,
    prior,
    weights,
)
from numpy_cae.cleanup.interpolation import interpolate_joints, mark_unknown_channels
from numpy_cae.cleanup.joint_regression import regress_positions
from numpy_cae.manifold.filling import HOLE_KINDS, classify_holes, complete_from_curves
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion import JOINTS
from numpy_cae.motion.hole_curves import (
    CURVES,
    interpolate_rotations,
    interpolate_values,
    slerp,
)
from numpy_cae.motion.joints import joint_mask
from numpy_cae.motion.quaternions import angle, from_vector, inverse, product

LEG = "right_knee right_ankle right_toe", "rfemur rtibia rfoot"


@pytest.mark.parametrize(
    ("joints", "unknown"),
    [("left_wrist", "lradius"), ("left_elbow", "lhumerus"), ("left_collar", ""), LEG],
)
def test_a_rotation_is_unknown_if_all_its_bones_end_at_missing_joints(joints, unknown):
    walk = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    turned, moved = mark_unknown_channels(walk, joint_mask(30, joints.split(), slice(10, 20)))
    names = [walk.skeleton.names[joint] for joint in np.flatnonzero(turned[15])]
    assert names == unknown.split()
    assert not turned[:10].any() and not turned[20:].any() and not moved.any()
    everything = mark_unknown_channels(walk, joint_mask(30, JOINTS, slice(10, 20)))
    assert everything[0][10:20].all() and everything[1][10:20, 0].all()


@pytest.mark.parametrize("rate", [30.0, 120.0])
def test_a_short_hole_in_a_parabola_is_the_parabola(rate):
    """Its speed is measured exactly, and a cubic with these values and speeds is the parabola."""
    t = np.arange(round(2 * rate)) / rate
    values = (1 + 2 * t - 3 * t**2)[:, None, None]
    missing = (abs(t - 1) < 0.2)[:, None]
    filled = interpolate_values(np.where(missing[..., None], np.nan, values), missing, rate)
    np.testing.assert_array_equal(filled[~missing], values[~missing])
    np.testing.assert_allclose(filled, values, atol=1e-9)


def test_rotations_turn_beyond_half_a_turn():
    frames = np.arange(60.0)[:, None]
    turning = from_vector(0.1 * frames[..., None] * [1.0, 0.0, 0.0])
    missing = (frames >= 20) & (frames < 35)
    spoilt = np.where(missing[..., None], [0.0, 0.0, 0.0, 1.0], turning)
    for curve in CURVES.values():
        filled = interpolate_rotations(spoilt, missing, 30.0, lambda *_, curve=curve: curve)
        assert angle(product(inverse(filled), turning)).max() < 1e-6


def test_weights_fall_with_the_power_of_the_error_and_start_at_the_prior():
    prior = np.log([1.0, 2.0])
    np.testing.assert_allclose(weights(prior, np.empty((0, 2)), 3.0), [8 / 9, 1 / 9])
    trials = np.full((int(PRIOR_TRIALS), 2), [0.04, 0.02])  # as many as the prior counts for
    np.testing.assert_allclose(weights(prior, trials, 3.0), [0.5, 0.5])


def test_trials_are_the_hole_in_known_frames():
    pattern = np.full((12, 20), "", "U4")
    pattern[3:, JOINTS.index("left_wrist")] = "end"
    known = abs(np.arange(100) - 45.5) > 6
    kinds, starts, size = place_trials(known, pattern, 30.0)
    hidden = (kinds != "").any(axis=1)
    assert size == 12 and starts == [6, 58]
    assert not hidden[~known].any() and hidden.sum() == 9 * len(starts)
    for start in starts:
        np.testing.assert_array_equal(kinds[start : start + 12], pattern)
    assert place_trials(known[38:60], pattern, 30.0).starts == []


def test_a_motion_on_a_smooth_curve_is_filled_by_the_cubic(walk_manifold):
    """A shoulder that swings as a sine, which a cubic follows and slerp does not."""
    walk = make_take("walk", 3, seconds=6.0, rate=30.0).motion
    swing = 1.5 * np.sin(np.arange(180) / 6)[:, None] * [1.0, 0.0, 0.0]
    rotations, shoulder = walk.rotations.copy(), walk.skeleton.index("lhumerus")
    rotations[:, shoulder] = from_vector(swing)
    motion = replace(walk, rotations=rotations)
    hole = joint_mask(180, ["left_elbow", "left_wrist"], slice(80, 90))
    choices = choose_candidates(walk_manifold, Body(motion, walk_manifold.lengths), hole)
    curves = {**CURVES, "slerp": slerp}
    filled = {
        name: interpolate_joints(motion, hole, lambda *_, c=c: c) for name, c in curves.items()
    }
    filled["chosen"] = interpolate_joints(motion, hole, choices.curve_at)
    for name, each in filled.items():
        filled[name] = angle(product(inverse(rotations), each.rotations))[80:90, shoulder].max()
    assert filled["chosen"] < min(0.2 * filled["slerp"], 1.5 * filled["cubic"])
    assert choices.strength.shape == (180, 20) and not choices.strength[~hole].any()


def test_a_motion_that_is_too_short_for_trials_has_the_share_of_other_sources(walk_manifold):
    walk = make_take("walk", 3, seconds=2.0, rate=30.0).motion
    hole = joint_mask(60, ["left_wrist"], slice(8, 53))
    choices = choose_candidates(walk_manifold, Body(walk, walk_manifold.lengths), hole)
    weight = weights(prior("shares", "end", 45 / 30), None, POWERS["shares"])
    share = choices.share_at(JOINTS.index("left_wrist"), 8)
    np.testing.assert_allclose(share, weight @ STRENGTHS)


def test_arms_are_predicted_by_the_visible_joints_and_poses_by_the_network(walk_manifold):
    walk = make_take("walk", 3, seconds=4.0, rate=30.0).motion
    features = Body(walk, walk_manifold.lengths).features
    arm = joint_mask(120, ["left_elbow", "left_wrist"], slice(50, 70))
    pose = joint_mask(120, JOINTS, slice(50, 70))
    of_arm = correct_features(walk_manifold, features, arm)
    np.testing.assert_array_equal(of_arm, regress_positions(features, arm))
    of_pose = correct_features(walk_manifold, features, pose)
    by_network = complete_from_curves(walk_manifold, features, pose, np.ones(pose.shape))
    np.testing.assert_array_equal(of_pose, by_network)


def test_limbs_without_a_visible_heading_are_holes_of_the_pose():
    all_but_hips = joint_mask(10, JOINTS[1:], slice(3, 7))
    arm = joint_mask(10, ["left_elbow", "left_wrist"], slice(3, 7))
    assert set(np.unique(classify_holes(all_but_hips))) == {0, HOLE_KINDS.index("pose")}
    assert set(np.unique(classify_holes(arm))) == {0, HOLE_KINDS.index("arm")}
