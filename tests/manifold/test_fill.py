"""Filling in: only unknown values change, in features and in files of any rig."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from data_synth import make_take
from numpy_cae.cleanup import fill_motion
from numpy_cae.manifold import fill, keyframe_mask
from numpy_cae.manifold.completion import complete
from numpy_cae.mocap import body_positions
from numpy_cae.motion import JOINTS, POSITIONS


def walk(seed, rate=30.0, frames=None):
    return make_take("walk", seed, seconds=2.0, rate=rate).motion.at(slice(frames))


def hole(frames, start, stop, *joints):
    missing = np.zeros((frames, 20), bool)
    missing[start:stop, list(joints)] = True
    return missing


@given(seed=st.integers(0, 999), frames=st.integers(1, 57), share=st.floats(0, 1))
def test_known_values_are_unchanged_and_missing_ones_are_ignored(
    walk_manifold, walk_features, seed, frames, share
):
    clip = walk_features[:frames]
    missing = np.random.default_rng(seed).random((frames, 20)) < share
    unknown = np.repeat(missing, 3, axis=1)
    spoilt = clip.copy()
    spoilt[:, POSITIONS][unknown] = np.nan
    filled = fill(walk_manifold, spoilt, missing)
    assert np.all(np.isfinite(filled))
    np.testing.assert_array_equal(filled, fill(walk_manifold, clip, missing))
    np.testing.assert_array_equal(filled[:, POSITIONS][~unknown], clip[:, POSITIONS][~unknown])
    np.testing.assert_array_equal(filled[:, 60:], clip[:, 60:])


def plainly_completed(manifold, features, known):
    """What the docstring of `numpy_cae.manifold.completion` says, column by column."""

    def curve(values):
        filled, frame = np.zeros_like(values), np.arange(len(values))
        for column in np.flatnonzero(known.any(axis=0)):
            keys = frame[known[:, column]]
            there = values[keys, column]
            filled[:, column] = there[0]
            if len(keys) > 1:
                slopes = CubicSpline(keys, there, bc_type="natural")(keys, 1)
                for n, (gap, rise) in enumerate(zip(np.diff(keys), np.diff(there), strict=True)):
                    if gap > 12:
                        slopes[n : n + 2] = slopes[n : n + 2].clip(*sorted((0, 3 * rise / gap)))
                spline = CubicHermiteSpline(keys, there, slopes)
                filled[:, column] = spline(np.clip(frame, keys[0], keys[-1]))
        return filled

    x = (features - manifold.mean_pose) * manifold.scale
    iterates = [np.where(known, x, curve(x))]
    last = False
    while not last:
        steps = np.linalg.norm(np.diff(iterates, axis=0), axis=(1, 2))
        last = len(steps) == 4 or (len(steps) and steps[-1] < steps[0] / 10)
        iterate = iterates[-1] / manifold.scale + manifold.mean_pose
        projected = manifold.project(iterate, average_shifts=last)
        projected = (projected - manifold.mean_pose) * manifold.scale
        iterates.append(np.where(known, x, projected + curve(x - projected)))
    return iterates[-1] / manifold.scale + manifold.mean_pose, len(iterates) - 1


@pytest.mark.parametrize("share", [0.3, 0.9, 0.995])
def test_completion_is_its_equation(walk_manifold, walk_features, share):
    known = np.random.default_rng(0).random(walk_features.shape) >= share
    known[:, 5] = False
    known[:, [0, 2]] = True  # always zero
    expected, projections = plainly_completed(walk_manifold, walk_features, known)
    assert projections < 5 or share > 0.5
    mean, scale = walk_manifold.mean_pose, walk_manifold.scale

    def project(x, averaged):
        return (walk_manifold.project(x[0] / scale + mean, averaged) - mean)[None] * scale

    x = np.where(known, (walk_features - mean) * scale, 0.0)
    completed = complete(x[None], known[None], project)[0] / scale + mean
    np.testing.assert_allclose(completed, expected, atol=1e-6)


def test_completion_ignores_unknown_values_and_returns_known_ones(walk_manifold, walk_features):
    known = np.random.default_rng(0).random(walk_features.shape) >= 0.5
    known[:, 5] = False
    known[:, [0, 2]] = True  # always zero
    completed = walk_manifold.complete(np.where(known, walk_features, np.nan), known)
    np.testing.assert_array_equal(completed[known], walk_features[known])
    lost = np.where(known, walk_features, walk_manifold.mean_pose)
    np.testing.assert_array_equal(walk_manifold.complete(lost), completed)


def test_a_mask_of_another_shape_is_refused(walk_manifold, walk_features):
    known = np.ones((3, 63), bool)
    with pytest.raises(ValueError, match=r"known has shape \(3, 63\), expected \(72, 63\)"):
        walk_manifold.complete(walk_features, known)


def test_invalid_arguments_are_refused(walk_manifold):
    with pytest.raises(ValueError, match=r"missing has shape \(3, 20\), expected \(60, 20\)"):
        fill_motion(walk(1), walk_manifold, np.zeros((3, 20), bool))


@pytest.mark.parametrize(("rate", "frames"), [(30.0, 37), (120.0, 148), (25.0, 37)])
@pytest.mark.parametrize(
    ("joint", "turned"),
    [("left_wrist", "lradius"), ("left_elbow", "lhumerus"), ("right_knee", "rfemur")],
)
def test_a_filled_joint_of_a_file_moves_alone(walk_manifold, rate, frames, joint, turned):
    motion = walk(3, rate, frames)
    place = JOINTS.index(joint)
    missing = hole(frames, frames // 4, frames // 2, place)
    filled = fill_motion(motion, walk_manifold, missing)
    assert (filled.motion.skeleton, filled.motion.rate) == (motion.skeleton, rate)
    np.testing.assert_array_equal(filled.touched, missing)
    np.testing.assert_array_equal(filled.motion.translations, motion.translations)
    differ = np.any(filled.motion.rotations != motion.rotations, axis=-1)
    assert differ[missing[:, place], motion.skeleton.index(turned)].all()
    assert not differ[~missing[:, place]].any()
    # The file holds the true motion, which the curve through its rotations nearly finds.
    assert 1e-5 < filled.moved[missing].max() < 0.15
    gap = body_positions(filled.motion) - body_positions(motion)
    assert np.linalg.norm(gap, axis=-1)[~missing].max() < 1e-6


@pytest.mark.parametrize("rate", [30.0, 25.0])
@pytest.mark.parametrize(("frames", "every"), [(37, 15), (37, 7), (1, 15), (8, 1), (9, 100)])
def test_keyframes_of_a_file_are_unchanged(walk_manifold, rate, frames, every):
    motion = walk(3, rate, frames)
    filled = fill_motion(motion, walk_manifold, keyframe_mask(frames, every)).motion
    keyframes = slice(None, None, every)
    after_the_last = slice((frames - 1) // every * every, None)
    for same in (keyframes, after_the_last):
        np.testing.assert_array_equal(filled.rotations[same], motion.rotations[same])
        np.testing.assert_array_equal(filled.translations[same], motion.translations[same])


@pytest.mark.parametrize("rate", [30.0, 120.0])
@pytest.mark.parametrize("joints", [("left_elbow", "left_wrist"), JOINTS])
def test_values_in_a_hole_are_ignored_and_its_ends_join(walk_manifold, rate, joints):
    """Rotation and speed have no jump: the step into a hole is near that before it."""
    motion = walk(3, rate)
    first = round(0.6 * rate)
    end = round(1.3 * rate)
    missing = hole(len(motion), first, end, *map(JOINTS.index, joints))
    rotations = motion.rotations.copy()
    translations = motion.translations.copy()
    rotations[missing.all(axis=1)] = rotations[first, None]
    rotations[first:end, motion.skeleton.index("lhumerus")] = [0.0, 1.0, 0.0, 0.0]
    translations[missing.all(axis=1), 0] += 3.0
    spoilt = replace(motion, rotations=rotations, translations=translations)
    positions = [
        body_positions(fill_motion(x, walk_manifold, missing).motion) for x in (motion, spoilt)
    ]
    np.testing.assert_allclose(positions[1], positions[0], atol=1e-6)
    filled = np.diff(positions[0], 2, axis=0)
    true = np.diff(body_positions(motion), 2, axis=0)
    assert np.abs(filled[[first - 2, end - 1]]).max() < 1.5 * np.abs(true).max()
