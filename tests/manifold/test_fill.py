"""Filling in: only unknown values change, in features and in files of any rig."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from data_synth import make_take
from numpy_cae.manifold import fill, fill_motion, keyframe_mask
from numpy_cae.motion import JOINTS, POSITIONS, body_positions, load_motion

WRIST = JOINTS.index("left_wrist")


def walk(seed, seconds=2.0, rate=30.0, frames=None):
    return make_take("walk", seed, seconds=seconds, rate=rate).motion.at(slice(frames))


def hole(frames, start, stop, *joints):
    missing = np.zeros((frames, 20), bool)
    missing[start:stop, list(joints)] = True
    return missing


@pytest.fixture(scope="module")
def manifold(walk_manifold):
    return walk_manifold


@pytest.fixture(scope="module")
def features(manifold):
    return manifold.body(walk(99, seconds=1.9)).features


def distance(one, other, missing):
    off = (one - other)[:, POSITIONS].reshape(-1, 20, 3)
    return np.linalg.norm(off, axis=-1)[missing].mean()


def test_a_hole_is_filled_better_than_by_the_spline(manifold, features):
    missing = hole(57, 12, 42, *range(JOINTS.index("left_hip"), JOINTS.index("left_toe") + 1))
    spline = fill(manifold, features, missing, repeats=0)
    assert distance(fill(manifold, features, missing), features, missing) < 0.8 * distance(
        spline, features, missing
    )


@given(seed=st.integers(0, 999), frames=st.integers(1, 57), share=st.floats(0, 1))
def test_known_values_stay_to_the_bit_and_old_ones_are_ignored(
    manifold, features, seed, frames, share
):
    clip = features[:frames]
    missing = np.random.default_rng(seed).random((frames, 20)) < share
    unknown = np.repeat(missing, 3, axis=1)
    spoilt = clip.copy()
    spoilt[:, POSITIONS][unknown] = np.nan
    filled = fill(manifold, spoilt, missing)
    assert np.all(np.isfinite(filled))
    np.testing.assert_array_equal(filled, fill(manifold, clip, missing))
    np.testing.assert_array_equal(filled[:, POSITIONS][~unknown], clip[:, POSITIONS][~unknown])
    np.testing.assert_array_equal(filled[:, 60:], clip[:, 60:])


def test_invalid_arguments_are_refused(manifold, features):
    with pytest.raises(ValueError, match="keyframes every 0 frames"):
        keyframe_mask(9, 0)
    with pytest.raises(ValueError, match=r"missing has shape \(3, 20\), expected \(57, 20\)"):
        fill(manifold, features, np.zeros((3, 20), bool))
    with pytest.raises(ValueError, match=r"missing has shape \(3, 20\)"):
        fill_motion(walk(1), manifold, np.zeros((3, 20), bool))


@pytest.mark.parametrize(("rate", "frames"), [(30.0, 37), (120.0, 148), (25.0, 37)])
@pytest.mark.parametrize("joint", ["left_wrist", "left_elbow", "right_knee"])
def test_a_filled_joint_of_a_file_moves_alone(manifold, rate, frames, joint):
    motion = walk(3, rate=rate, frames=frames)
    place = JOINTS.index(joint)
    missing = hole(frames, frames // 4, frames // 2, place)
    filled = fill_motion(motion, manifold, missing)
    assert (filled.motion.skeleton, filled.motion.rate) == (motion.skeleton, rate)
    np.testing.assert_array_equal(filled.touched, missing)
    np.testing.assert_array_equal(filled.motion.translations, motion.translations)
    known = ~missing[:, place]
    np.testing.assert_array_equal(filled.motion.rotations[known], motion.rotations[known])
    assert filled.moved[missing].max() > 0.001
    assert filled.moved[~missing].max() < 1e-6
    # No jump where the hole begins and ends.
    step, own = (
        np.linalg.norm(np.diff(body_positions(each)[:, place], axis=0), axis=-1).max()
        for each in (filled.motion, motion)
    )
    assert step < 1.5 * own


@pytest.mark.parametrize("rate", [30.0, 25.0])
@pytest.mark.parametrize(("frames", "every"), [(37, 15), (37, 7), (1, 15), (8, 1), (9, 100)])
def test_keyframes_of_a_file_are_kept_to_the_bit(manifold, rate, frames, every):
    motion = walk(3, rate=rate, frames=frames)
    filled = fill_motion(motion, manifold, keyframe_mask(frames, every)).motion
    last = (frames - 1) // every * every
    for kept in (slice(None, None, every), slice(last, None)):
        np.testing.assert_array_equal(filled.rotations[kept], motion.rotations[kept])
        np.testing.assert_array_equal(filled.translations[kept], motion.translations[kept])


def test_a_stepped_file_is_filled_nearer_to_the_truth_than_held(manifold):
    motion = walk(99, rate=120.0)
    held = np.arange(len(motion)) // 40 * 40
    missing = keyframe_mask(len(motion), 40)
    truth = body_positions(motion)
    filled = body_positions(fill_motion(motion.at(held), manifold, missing).motion)
    assert np.abs(np.diff(filled, axis=0)).max() < 2 * np.abs(np.diff(truth, axis=0)).max()
    error, held_error = (
        np.linalg.norm(each - truth, axis=-1)[missing[:, 0]].mean()
        for each in (filled, truth[held])
    )
    assert error < 0.4 * held_error


def test_real_files_of_two_rigs(manifold, data_folder):
    bandai = load_motion(data_folder / "bandai" / "dataset-2_walk_normal_001.bvh")
    cmu = load_motion(data_folder / "cmu" / "asfamc" / "02" / "02_03.amc")
    for motion, elbow in ((bandai, "LowerArm_L"), (cmu, "lradius")):
        filled = fill_motion(motion, manifold, hole(len(motion), 10, 40, WRIST)).motion
        differ = np.any(filled.rotations != motion.rotations, axis=(0, 2))
        assert list(np.flatnonzero(differ)) == [motion.skeleton.index(elbow)]
