"""Detection: damage is found, and what is clean is left alone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data_synth import make_take
from numpy_cae.manifold import repair, starter
from numpy_cae.manifold.detect import (
    between_jumps,
    find_frozen,
    find_jumps,
    find_repeated,
    find_stretched,
)
from numpy_cae.motion import JOINTS, POSITIONS, body_positions

LEG = [JOINTS.index(f"left_{joint}") for joint in ("knee", "ankle", "toe")]
ARM = [JOINTS.index(f"left_{joint}") for joint in ("elbow", "wrist")]


@pytest.fixture(scope="module")
def manifold():
    return starter()


@pytest.fixture(scope="module")
def walk():
    return make_take("walk", 77, seconds=5.0, rate=60.0).motion


def turned(motion, degrees, axis, frames=slice(None)):
    """The motion with joints of the rig, by name, turned about their own axis in some frames."""
    rotations = motion.rotations.copy()
    for joint, angle in degrees.items():
        index = motion.skeleton.index(joint)
        turn = Rotation.from_euler(axis, np.reshape(angle, (-1, 1)), degrees=True)
        rotations[frames, index] = (Rotation.from_quat(rotations[frames, index]) * turn).as_quat()
    return replace(motion, rotations=rotations)


def error(motion, truth, frames, joints):
    off = body_positions(motion)[frames][:, joints] - body_positions(truth)[frames][:, joints]
    return np.linalg.norm(off, axis=-1).mean()


def assert_other_frames_are_kept(repaired, motion):
    untouched = ~repaired.touched.any(axis=1)
    np.testing.assert_array_equal(repaired.motion.rotations[untouched], motion.rotations[untouched])


def test_a_clean_motion_is_left_as_it_is(manifold, walk):
    repaired = repair(walk, manifold)
    assert repaired.known
    assert repaired.touched.mean() < 0.01
    assert_other_frames_are_kept(repaired, walk)
    assert repaired.moved[~repaired.touched].max(initial=0.0) < 1e-6


@pytest.mark.parametrize(
    ("joint", "degrees", "frames", "expected", "share"),
    [("lfemur", 50.0, slice(120, 200), LEG, 0.3), ("lhumerus", 60.0, slice(101, 102), ARM, 0.15)],
)
def test_a_turned_limb_is_found_and_repaired(
    manifold, walk, joint, degrees, frames, expected, share
):
    damaged = turned(walk, {joint: degrees}, "z", frames)
    repaired = repair(damaged, manifold)
    assert repaired.touched[frames][:, expected].mean() > 0.9
    before, after = (error(each, walk, frames, expected) for each in (damaged, repaired.motion))
    assert after < share * before
    assert_other_frames_are_kept(repaired, damaged)
    half = repair(damaged, manifold, damaged=repaired.touched, strength=0.5).motion
    assert after < error(half, walk, frames, expected) < before


def test_a_pose_that_begins_and_ends_smoothly_and_lasts_is_no_damage(manifold):
    """Someone kneels down, stays and stands up again: no model of walks knows it."""
    motion = make_take("walk", 4, seconds=8.0, rate=30.0).motion
    degrees = 100 * np.interp(np.arange(len(motion)), [60, 80, 150, 170], [0, 1, 1, 0])
    kneels = turned(motion, {"lfemur": -0.5 * degrees, "ltibia": degrees}, "x")
    assert not repair(kneels, manifold).touched.any()


def test_an_unknown_motion_is_unchanged_unless_forced(manifold):
    lying = make_take("idle", 1, seconds=3.0, rate=30.0).motion
    rng = np.random.default_rng(0)
    rotations = Rotation.random(lying.rotations[..., 0].size, rng).as_quat()
    chaos = replace(lying, rotations=rotations.reshape(lying.rotations.shape))
    repaired = repair(chaos, manifold)
    assert not repaired.known
    assert repaired.motion is chaos
    assert not repaired.touched.any()
    assert repair(chaos, manifold, force=True).known


def test_a_frozen_arm_is_found_and_limbs_at_rest_are_not(manifold, walk):
    frames, rotations = slice(120, 210), walk.rotations.copy()
    for joint in ("lhumerus", "lradius"):
        index = walk.skeleton.index(joint)
        rotations[frames, index] = rotations[frames.start, index]
    stopped = replace(walk, rotations=rotations)
    for motion, stops in ((stopped, True), (walk, False)):
        body = manifold.body(motion)
        local = body.features[:, POSITIONS].reshape(-1, 20, 3)
        frozen = find_frozen(body, body.positions, local)
        assert frozen[61:104, ARM[1]].all() == frozen.any() == stops
    assert repair(stopped, manifold).touched[124:206, ARM[1]].all()


def test_values_that_are_not_finite_are_filled_in(manifold, walk):
    rotations, elbow = walk.rotations.copy(), walk.skeleton.index("lradius")
    rotations[50:60, elbow] = np.nan
    repaired = repair(replace(walk, rotations=rotations), manifold)
    assert np.all(np.isfinite(repaired.motion.rotations))
    assert repaired.touched[50:60, ARM[1]].all()
    assert error(repaired.motion, walk, slice(50, 60), ARM[1:]) < 0.02
    assert_other_frames_are_kept(repaired, walk)


def test_direct_tests():
    t = np.arange(60)[:, None, None]
    walking = 0.02 * t * np.ones((1, 20, 3))
    points = walking + np.arange(20)[None, :, None]
    assert not between_jumps(*find_jumps(points), 3).any()
    points[30:32, 7] += 0.5
    expected = np.zeros((60, 20), bool)
    expected[30:32, 7] = True
    np.testing.assert_array_equal(between_jumps(*find_jumps(points), 3), expected)
    assert not between_jumps(*find_jumps(points), 1).any()
    np.testing.assert_array_equal(find_stretched(points), expected)
    repeats = walking[np.where((t.ravel() > 20) & (t.ravel() < 30), 20, t.ravel())]
    np.testing.assert_array_equal(np.flatnonzero(find_repeated(repeats)), np.arange(21, 30))
    stands = np.concatenate([walking, walking[-1:].repeat(20, axis=0)])
    assert not find_repeated(stands).any()
