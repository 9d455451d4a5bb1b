"""The measures of valid motion, where the answer is known or computed by an exhaustive search."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from data_synth import make_take
from numpy_cae import mocap, motion
from numpy_cae.motion.fit import body_skeleton
from studies.shared.validity import Validity, ValidityMeasure, bone_length_error

LENGTHS = np.array([0, 12, 12, 30] + [13, 5, 25, 23] * 2 + [10, 40, 41, 13] * 2) / 100


@pytest.fixture(scope="module")
def walk() -> np.ndarray:
    return mocap.body_of(make_take("walk", 3, seconds=4.0, rate=30.0).motion)


def t_pose() -> np.ndarray:
    """Two frames of a T-pose, (2, 20, 3)."""
    skeleton = body_skeleton(LENGTHS)
    pose = np.zeros((20, 3))
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            pose[joint] = pose[parent] + skeleton.offsets[joint]
    return np.repeat(pose[None], 2, axis=0)


@given(st.floats(0.5, 2.0))
def test_a_scaled_body_has_the_error_of_its_scale(size):
    expected = 100 * abs(size - 1) * np.sqrt(np.mean(LENGTHS[1:] ** 2))
    assert bone_length_error(size * t_pose(), LENGTHS) == pytest.approx(expected)


def test_the_nearest_pose_equals_an_exhaustive_search(walk):
    rng = np.random.default_rng(0)
    features, _ = motion.positions_to_features(walk, 30.0)
    queries = features[::7] + rng.normal(0, 0.02, features[::7].shape)
    squares = (queries[:, None, :60] - features[None, :, :60]) ** 2
    expected = 100 * np.sqrt(squares.mean(axis=-1).min(axis=1))
    measure = ValidityMeasure([features], LENGTHS, 30.0)
    np.testing.assert_allclose(measure.nearest_distances(queries), expected)


@pytest.fixture
def measured(walk):
    """The measures of a walk, and of the walk with noise."""
    features, _ = motion.positions_to_features(walk, 30.0)
    measure = ValidityMeasure([features], motion.bone_lengths(walk), 30.0)
    noise = np.random.default_rng(0).normal(0, 0.03, features.shape)
    return measure.of(features), measure.of(features + noise)


def test_a_pose_of_real_motion_is_its_own_nearest(measured):
    real, _ = measured
    assert real.nearest_pose == 0


@pytest.mark.parametrize("name", ["bone_length", "foot_sliding", "jitter", "nearest_pose"])
def test_noise_makes_every_measure_worse(measured, name):
    real, noisy = measured
    assert getattr(noisy, name) > getattr(real, name)


def test_the_mean_of_two_motions(measured):
    real, noisy = measured
    mean = Validity.mean([real, noisy])
    assert mean.jitter == pytest.approx((real.jitter + noisy.jitter) / 2)


def test_measures_are_compared_in_a_sentence():
    text = Validity(1, 2, 3, 1).against(Validity(1, 2, 4, 1))
    assert "jitter, m/s² 3.00 against 4.00" in text
