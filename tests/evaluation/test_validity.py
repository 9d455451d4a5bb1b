"""The measures of validity, where the answer can be computed by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from data_synth import make_take
from numpy_cae.evaluation import (
    Validity,
    ValidityMeasure,
    bone_length_error,
    foot_sliding,
)
from numpy_cae.evaluation.validity import NearestPose
from numpy_cae.motion import JOINTS, body_of, bone_lengths, positions_to_features
from numpy_cae.motion.retarget.fit import body_skeleton

LENGTHS = np.array([0, 12, 12, 30] + [13, 5, 25, 23] * 2 + [10, 40, 41, 13] * 2) / 100
LEFT_TOE, RIGHT_TOE = JOINTS.index("left_toe"), JOINTS.index("right_toe")


def standing(frames: int = 20) -> np.ndarray:
    """A T-pose, its toes on the floor, (frames, 20, 3)."""
    skeleton = body_skeleton(LENGTHS)
    pose = np.zeros((20, 3))
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            pose[joint] = pose[parent] + skeleton.offsets[joint]
    pose[:, 1] -= pose[LEFT_TOE, 1]
    return np.repeat(pose[None], frames, axis=0)


@pytest.fixture(scope="module")
def walk() -> np.ndarray:
    return body_of(make_take("walk", 3, seconds=4.0, rate=30.0).motion)


@given(st.floats(0.5, 2.0))
def test_a_scaled_body_has_the_error_of_its_scale(size):
    expected = 100 * abs(size - 1) * np.sqrt(np.mean(LENGTHS[1:] ** 2))
    assert bone_length_error(size * standing(2), LENGTHS) == pytest.approx(expected)


@given(st.floats(0.0, 3.0), st.floats(-np.pi, np.pi))
def test_a_translated_pose_slides_at_its_speed(speed, direction):
    pushed = standing()
    path = np.arange(20)[:, None] / 30 * speed * np.array([[np.cos(direction), np.sin(direction)]])
    pushed[..., [0, 2]] += path[:, None]
    assert foot_sliding(pushed, 30.0) == pytest.approx(100 * speed)
    assert foot_sliding(pushed + [0, 1.0, 0], 30.0) == pytest.approx(100 * speed)
    assert foot_sliding(pushed + [0, 1.0, 0], 30.0, floor=0.0) == 0


def test_only_the_lower_foot_counts():
    hopping = standing()
    hopping[:, RIGHT_TOE, 1] += 0.02  # near the floor too, and fast
    hopping[:, RIGHT_TOE, 2] += np.arange(20)
    assert foot_sliding(hopping, 30.0) == 0
    hopping[:, LEFT_TOE, 1] += 0.03
    assert foot_sliding(hopping, 30.0) == pytest.approx(3000)


def test_the_nearest_pose_equals_an_exhaustive_search(walk):
    rng = np.random.default_rng(0)
    features, _ = positions_to_features(walk, 30.0)
    queries = features[::7] + rng.normal(0, 0.02, features[::7].shape)
    apart = (queries[:, None, :60] - features[None, :, :60]) ** 2
    expected = 100 * np.sqrt(apart.mean(axis=-1).min(axis=1))
    nearest = NearestPose(features)
    np.testing.assert_allclose(nearest.distances(queries), expected)
    assert not nearest.distances(features).any()


def test_validity_is_all_measures(walk):
    features, _ = positions_to_features(walk, 30.0)
    measure = ValidityMeasure([features], bone_lengths(walk), 30.0)
    real = measure.of(features)
    noisy = measure.of(features + np.random.default_rng(0).normal(0, 0.03, features.shape))
    assert real.nearest_pose == 0
    for name in ("bone_length", "foot_sliding", "jitter", "nearest_pose"):
        assert getattr(noisy, name) > getattr(real, name)
    middle = Validity.mean([real, noisy])
    assert middle.jitter == pytest.approx((real.jitter + noisy.jitter) / 2)
    assert len(Validity.FORMATS) == 1 + len(Validity.HEADER)
    assert "jitter, m/s² 3.00 against 4.00" in Validity(1, 2, 3, 1).against(Validity(1, 2, 4, 1))
