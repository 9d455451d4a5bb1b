"""Section 4 of holden2015: the 63 features and their inverse, heading, lengths and windows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from numpy_cae.motion import JOINTS, PARENTS, Motion, bone_lengths, change_lengths, cut_windows
from numpy_cae.motion.features import (
    POSITIONS,
    TURN,
    VELOCITY,
    features_to_positions,
    heading,
    joint_slice,
    positions_to_features,
    smooth,
)
from numpy_cae.motion.fit import body_skeleton, fit_motion

SIDES = ("left", "right")
STEADY = [JOINTS.index(f"{side}_{end}") for side in SIDES for end in ("hip", "shoulder")] + [0]
"""The joints that say where the body stands and faces."""
LENGTHS = np.array([0, 12, 12, 30] + [13, 5, 25, 23] * 2 + [10, 40, 41, 13] * 2) / 100


def body(frames=40, seed=0, turn=0.0, speed=0.02):
    """A body in a T-pose with moving limbs, walking along its heading and turning."""
    rng = np.random.default_rng(seed)
    skeleton = body_skeleton(LENGTHS)
    pose = np.zeros((len(JOINTS), 3))
    for joint, parent in enumerate(PARENTS):
        pose[joint] = (pose[parent] if parent >= 0 else [0, 0.95, 0]) + skeleton.offsets[joint]
    swing = np.sin(np.arange(frames) / 4)[:, None, None] * rng.normal(scale=0.05, size=(20, 3))
    swing[:, STEADY] = 0.0
    angle = rng.uniform(-3, 3) + turn * np.arange(frames)
    forward = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)
    path = np.cumsum(speed * forward, axis=0) + [rng.normal(), 0, rng.normal()]
    c, s, zero, ones = np.cos(angle), np.sin(angle), 0 * angle, 0 * angle + 1
    about_y = np.array([[c, zero, s], [zero, ones, zero], [-s, zero, c]]).transpose(2, 0, 1)
    return (pose + swing) @ about_y.transpose(0, 2, 1) + path[:, None], angle


@given(frames=st.integers(1, 60), seed=st.integers(0, 2**32 - 1), turn=st.floats(-0.2, 0.2))
def test_there_and_back_is_exact(frames, seed, turn):
    positions, _ = body(frames, seed, turn)
    features, start = positions_to_features(positions, 30.0)
    assert features.shape == (frames, 63)
    np.testing.assert_allclose(features_to_positions(features, start), positions, atol=1e-9)


@given(seed=st.integers(0, 2**32 - 1), shift=st.floats(-5, 5), angle=st.floats(-6, 6))
def test_features_do_not_know_where_the_body_stands_and_faces(seed, shift, angle):
    positions, _ = body(30, seed, 0.05)
    c, s = np.cos(angle), np.sin(angle)
    moved = positions @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]) + [shift, 0, -2 * shift]
    features, start = positions_to_features(positions, 30.0)
    same, elsewhere = positions_to_features(moved, 30.0)
    np.testing.assert_allclose(same, features, atol=1e-9)
    assert np.sin(elsewhere.heading - start.heading - angle) == pytest.approx(0, abs=1e-9)


def test_the_named_slices_hold_what_they_say():
    """A body that walks 2 cm a frame straight ahead and turns 3° a frame."""
    positions, _ = body(60, turn=np.radians(3), speed=0.02)
    features, _ = positions_to_features(positions, 30.0)
    middle = slice(20, 40)  # smoothing has nothing to see beyond the ends
    np.testing.assert_allclose(features[middle, TURN], np.radians(3), atol=2e-3)
    x, z = features[middle, VELOCITY].T
    np.testing.assert_allclose(x, 0, atol=2e-3)
    np.testing.assert_allclose(z, 0.02, atol=1e-4)
    local = features[:, POSITIONS].reshape(60, 20, 3)
    np.testing.assert_allclose(local[:, 0, [0, 2]], 0, atol=1e-12)
    np.testing.assert_allclose(local[:, :, 1], positions[:, :, 1])
    wrist = JOINTS.index("left_wrist")
    np.testing.assert_array_equal(features[:, joint_slice("left_wrist")], local[:, wrist])
    assert np.all(local[:, wrist, 0] > 0), "the left hand is on the body's +X"


def test_heading_follows_the_body_and_never_jumps():
    positions, angle = body(200, turn=0.15)
    theta = heading(positions, 30.0)
    off = theta - angle
    off -= 2 * np.pi * np.round(off[100] / (2 * np.pi))
    np.testing.assert_allclose(off[30:-30], 0, atol=0.05)
    assert np.abs(np.diff(theta)).max() < 0.3


@pytest.mark.parametrize("frames", [1, 5, 200])
def test_the_smoothing_of_the_heading_holds_the_ends_as_scipys_does(frames):
    values = np.random.default_rng(frames).normal(size=(frames, 3))
    expected = gaussian_filter1d(values, 10.0, axis=0, mode="nearest")
    np.testing.assert_allclose(smooth(values, 10.0), expected, atol=1e-12)


@pytest.mark.parametrize("without_length", [False, True])
def test_lengths_are_changed_and_changed_back(without_length):
    """A bone without length continues the one above: CMU's BVH has both collars on the chest."""
    positions, _ = body(20)
    collar = JOINTS.index("left_collar")
    if without_length:
        positions[:, collar] = positions[:, JOINTS.index("chest")]
    lengths, longer = bone_lengths(positions), LENGTHS * 1.2
    changed = change_lengths(positions, lengths, longer)
    nearly = np.where(np.arange(20) == collar, 0.05 * without_length, 1e-9)
    assert np.all(np.abs(bone_lengths(changed) - longer) <= nearly * longer + 1e-12)
    np.testing.assert_allclose(change_lengths(changed, longer, lengths), positions, atol=1e-12)


@pytest.mark.parametrize(
    ("frames", "starts"),
    [(160, [0]), (240, [0, 80]), (400, [0, 80, 160, 240]), (190, [0, 30]), (161, [0, 1])],
)
def test_windows_overlap_by_half_and_show_every_frame(frames, starts):
    features = np.arange(frames)[:, None] * np.ones(63)
    windows, real = cut_windows(features)
    assert list(windows[:, 0, 0]) == starts
    assert windows.shape == (len(starts), 160, 63)
    assert real.all()


def test_a_short_take_holds_its_last_pose():
    positions, _ = body(50)
    features, start = positions_to_features(positions, 30.0)
    (window,), (real,) = cut_windows(features)
    np.testing.assert_array_equal(real, np.arange(160) < 50)
    held = positions[np.minimum(np.arange(160), 49)]
    np.testing.assert_allclose(features_to_positions(window, start), held, atol=1e-9)


def test_fitted_bones_follow_the_positions():
    """A body of rigid fans comes back exactly, whatever pose it takes."""
    rng = np.random.default_rng(0)
    skeleton = body_skeleton(LENGTHS)
    turns = Rotation.from_rotvec(rng.normal(scale=0.4, size=(15 * 20, 3))).as_quat()
    rotations = turns.reshape(15, 20, 4)
    translations = np.repeat(skeleton.offsets[None], 15, axis=0)
    translations[:, 0] = rng.normal(size=(15, 3))
    truth = Motion(skeleton, 30.0, rotations, translations).positions()
    fitted = fit_motion(truth, LENGTHS, 30.0)
    np.testing.assert_allclose(fitted.positions(), truth, atol=5e-4)
