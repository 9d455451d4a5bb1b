"""Filling in: only unknown values change, in features and in files of any rig."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from data_synth import make_take
from numpy_cae.manifold import fill_joint, fill_keyframes, fill_motion_joint, fill_motion_keyframes
from numpy_cae.motion import JOINTS, body_positions, features_to_positions, joint_slice, load_motion


def walk(seed, seconds=2.0, rate=30.0, frames=None):
    motion = make_take("walk", seed, seconds=seconds, rate=rate).motion
    return replace(
        motion, rotations=motion.rotations[:frames], translations=motion.translations[:frames]
    )


@pytest.fixture(scope="module")
def manifold(walk_manifold):
    return walk_manifold


@pytest.fixture(scope="module")
def features(manifold):
    return manifold.body(walk(99, seconds=1.9)).features


@pytest.mark.parametrize("joint", ["left_wrist", "right_ankle"])
def test_a_joint_is_nearer_to_the_truth_than_in_the_mean_pose(manifold, features, joint):
    place = joint_slice(joint)
    filled = fill_joint(manifold, features, joint)
    error = np.abs(filled - features)[:, place].mean()
    assert error < 0.85 * np.abs(manifold.mean_pose[place] - features[:, place]).mean()
    np.testing.assert_array_equal(np.delete(filled, place, 1), np.delete(features, place, 1))


def test_old_values_are_ignored_where_the_joint_is_unknown_and_kept_elsewhere(manifold, features):
    place = joint_slice("left_wrist")
    other, unknown, gap = features.copy(), features.copy(), features.copy()
    other[:, place] = 7.0
    unknown[:, place] = np.nan
    filled = fill_joint(manifold, features, "left_wrist")
    for start in (other, unknown):
        np.testing.assert_array_equal(fill_joint(manifold, start, "left_wrist"), filled)
    gap[10:20, place.start + 1] = np.nan
    filled = fill_joint(manifold, gap, "left_wrist")
    assert np.all(np.isfinite(filled))
    np.testing.assert_array_equal(
        np.delete(filled, np.s_[10:20], 0), np.delete(features, np.s_[10:20], 0)
    )
    assert np.all(filled[10:20, place] != features[10:20, place])


@given(every=st.integers(1, 40), frames=st.integers(1, 57), start=st.sampled_from(["line", "held"]))
def test_keyframes_are_met_exactly_wherever_they_are(manifold, features, every, frames, start):
    clip = features[:frames]
    filled = fill_keyframes(manifold, clip, every, start)
    assert filled.shape == clip.shape
    np.testing.assert_array_equal(filled[::every, :60], clip[::every, :60])
    np.testing.assert_allclose(
        features_to_positions(filled)[::every], features_to_positions(clip)[::every], atol=1e-9
    )


def test_filled_poses_are_nearer_to_the_truth_than_held_ones_and_do_not_jump(manifold, features):
    held = features[np.arange(len(features)) // 10 * 10]
    known = slice(0, (len(features) - 1) // 10 * 10 + 1)

    def error(filled):
        return np.abs(filled - features)[known, :60].mean()

    filled = fill_keyframes(manifold, features, 10)
    assert error(fill_keyframes(manifold, features, 10, "held")) < error(held)
    assert error(filled) < 0.6 * error(held)
    step, own_step = (np.abs(np.diff(x[:, :60], axis=0)).max() for x in (filled, features))
    assert step < 2 * own_step


def test_invalid_arguments_are_refused(manifold, features):
    for call, message in (
        (lambda: fill_joint(manifold, features, "nose"), "no joint 'nose', expected one of hips, "),
        (lambda: fill_keyframes(manifold, features, 0), "keyframes every 0 frames"),
        (lambda: fill_keyframes(manifold, features, 15, "cubic"), "start is 'cubic'"),
        (lambda: fill_motion_keyframes(walk(1), manifold, 0), "keyframes every 0 frames"),
        (lambda: fill_motion_joint(walk(1), manifold, "left_hip"), "left_hip is fixed .*_wrist, "),
        (lambda: fill_motion_joint(walk(1), manifold, "nose"), "no joint 'nose'"),
    ):
        with pytest.raises(ValueError, match=message):
            call()


@pytest.mark.parametrize(("rate", "frames"), [(30.0, 37), (120.0, 1), (25.0, 37)])
@pytest.mark.parametrize(
    ("joint", "turns"),
    [
        ("left_wrist", {"lradius"}),
        ("left_elbow", {"lhumerus", "lradius"}),
        ("right_knee", {"rfemur", "rtibia", "rfoot"}),  # the toe stays too
        ("head", {"lowerneck", "upperneck"}),
        ("spine", {"lowerback", "upperback", "thorax"}),
    ],
)
def test_a_filled_joint_of_a_file_moves_alone(manifold, rate, frames, joint, turns):
    motion = walk(3, rate=rate, frames=frames)
    filled = fill_motion_joint(motion, manifold, joint)
    assert (filled.skeleton, filled.rate, len(filled)) == (motion.skeleton, rate, frames)
    np.testing.assert_array_equal(filled.translations, motion.translations)
    differ = np.abs(filled.rotations - motion.rotations).max(axis=(0, 2))
    # To the bit; the chest above a moved spine turns back by a fit, which is right to 1e-6.
    differ = differ > (1e-6 if joint == "spine" else 0.0)
    assert {motion.skeleton.names[j] for j in np.flatnonzero(differ)} <= turns
    moved = np.linalg.norm(body_positions(filled) - body_positions(motion), axis=-1).max(axis=0)
    place = JOINTS.index(joint)
    assert moved[place] > 0.001
    assert np.delete(moved, place).max() < 1e-6


@pytest.mark.parametrize("rate", [30.0, 25.0])
@pytest.mark.parametrize(("frames", "every"), [(37, 15), (37, 7), (1, 15), (8, 1), (9, 100)])
def test_keyframes_of_a_file_are_kept_to_the_bit(manifold, rate, frames, every):
    motion = walk(3, rate=rate, frames=frames)
    filled = fill_motion_keyframes(motion, manifold, every)
    assert (filled.skeleton, filled.rate, len(filled)) == (motion.skeleton, rate, frames)
    np.testing.assert_array_equal(filled.rotations[::every], motion.rotations[::every])
    np.testing.assert_array_equal(filled.translations[::every], motion.translations[::every])


def test_a_stepped_file_is_filled_as_a_whole_one_and_nearer_to_the_truth_than_held(manifold):
    motion = walk(99, rate=120.0)
    held = np.arange(len(motion)) // 40 * 40
    stepped = replace(
        motion, rotations=motion.rotations[held], translations=motion.translations[held]
    )
    one, two = (fill_motion_keyframes(m, manifold, 40) for m in (motion, stepped))
    np.testing.assert_array_equal(one.rotations, two.rotations)
    np.testing.assert_array_equal(one.translations, two.translations)
    truth, filled = body_positions(motion), body_positions(one)
    assert np.abs(np.diff(filled, axis=0)).max() < 2 * np.abs(np.diff(truth, axis=0)).max()
    last = (len(motion) - 1) // 40 * 40
    error, held_error = (
        np.linalg.norm(each - truth, axis=-1)[:last].mean() for each in (filled, truth[held])
    )
    assert error < 0.4 * held_error


def test_real_files_of_two_rigs(manifold, data_folder):
    bandai = load_motion(data_folder / "bandai" / "dataset-2_walk_normal_001.bvh")
    cmu = load_motion(data_folder / "cmu" / "asfamc" / "02" / "02_03.amc")
    for motion, elbow in ((bandai, "LowerArm_L"), (cmu, "lradius")):
        filled = fill_motion_joint(motion, manifold, "left_wrist")
        differ = np.any(filled.rotations != motion.rotations, axis=(0, 2))
        assert list(np.flatnonzero(differ)) == [motion.skeleton.index(elbow)]
        filled = fill_motion_keyframes(motion, manifold, 15)
        np.testing.assert_array_equal(filled.rotations[::15], motion.rotations[::15])
    with pytest.raises(ValueError, match="spine is fixed"):
        fill_motion_joint(bandai, manifold, "spine")
