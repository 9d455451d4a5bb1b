"""The measures of motions, sets of clips and retrieval, where the answer is computed by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from numpy_cae import motion
from numpy_cae.evaluation import (
    clip_distances,
    diversity,
    jitter,
    nearest_distance,
    nearest_neighbour_accuracy,
)
from numpy_cae.evaluation.tables import Clips
from numpy_cae.motion import JOINTS
from numpy_cae.motion.contacts import foot_sliding
from numpy_cae.motion.fit import body_skeleton

LENGTHS = np.array([0, 12, 12, 30] + [13, 5, 25, 23] * 2 + [10, 40, 41, 13] * 2) / 100
LEFT_TOE, RIGHT_TOE = JOINTS.index("left_toe"), JOINTS.index("right_toe")


@pytest.mark.parametrize("rate", [30.0, 120.0])
def test_a_falling_body_has_the_acceleration_of_gravity(rate):
    t = np.arange(20) / rate
    positions = np.zeros((20, 2, 3))
    positions[:, :, 1] = -9.81 / 2 * t[:, None] ** 2
    positions[:, :, 0] = 3.0 * t[:, None]
    assert jitter(positions, rate) == pytest.approx(9.81)
    with pytest.raises(ValueError, match=r"\(2, 2, 3\), expected \(3 frames or more"):
        jitter(positions[:2], rate)


def test_velocities_and_padded_frames_do_not_count_and_one_joint_can_count_alone():
    truth = np.zeros((2, 8, 63))
    off = truth.copy()
    off[..., motion.POSITIONS.stop :] = 5.0
    off[:, 6:] = 7.0
    off[:, :6, motion.joint_slice("left_wrist")] = 0.03
    real = np.tile(np.arange(8) < 6, (2, 1))
    clips = Clips(SimpleNamespace(scale=np.ones(63)), truth, real, np.arange(2))
    assert clips.error(off) == pytest.approx(3 / np.sqrt(20))
    assert clips.error(off, "left_wrist") == pytest.approx(3.0)
    assert clips.error(off, "right_wrist") == 0.0


def standing(frames: int = 20) -> np.ndarray:
    """A T-pose, its toes on the floor, (frames, 20, 3)."""
    skeleton = body_skeleton(LENGTHS)
    pose = np.zeros((20, 3))
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            pose[joint] = pose[parent] + skeleton.offsets[joint]
    pose[:, 1] -= pose[LEFT_TOE, 1]
    return np.repeat(pose[None], frames, axis=0)


@given(st.floats(0.0, 3.0), st.floats(-np.pi, np.pi))
def test_a_translated_pose_slides_at_its_speed(speed, direction):
    pushed = standing()
    path = np.arange(20)[:, None] / 30 * speed * np.array([[np.cos(direction), np.sin(direction)]])
    pushed[..., [0, 2]] += path[:, None]
    assert foot_sliding(pushed, 30.0) == pytest.approx(100 * speed)
    assert foot_sliding(pushed + [0, 1.0, 0], 30.0) == pytest.approx(100 * speed)


def test_only_the_lower_foot_counts():
    hopping = standing()
    hopping[:, RIGHT_TOE, 1] += 0.02  # near the floor too, and fast
    hopping[:, RIGHT_TOE, 2] += np.arange(20)
    assert foot_sliding(hopping, 30.0) == 0
    hopping[:, LEFT_TOE, 1] += 0.03
    assert foot_sliding(hopping, 30.0) == pytest.approx(3000)


def drawn(count, seed, shift=0.0):
    return np.random.default_rng(seed).normal(shift, 1.0, (count, 2, 2))


def test_the_distance_is_the_root_mean_square_and_diversity_its_mean_within_a_set():
    a, b = drawn(3, 0), drawn(4, 1)
    direct = np.sqrt(((a[:, None] - b[None]) ** 2).mean(axis=(2, 3)))
    assert np.allclose(clip_distances(a, b), direct)
    assert nearest_distance(a, b) == pytest.approx(direct.min(axis=1).mean())
    assert diversity(np.repeat(a[:1], 5, axis=0)) == pytest.approx(0, abs=1e-7)
    within = clip_distances(a, a)
    assert diversity(a) == pytest.approx((within[0, 1] + within[0, 2] + within[1, 2]) / 3)


def test_the_two_sample_test_of_equal_different_and_copied_sets():
    real = drawn(400, 0)
    assert nearest_neighbour_accuracy(real, drawn(400, 1)) == pytest.approx(0.5, abs=0.05)
    assert nearest_neighbour_accuracy(real, drawn(400, 1, shift=8.0)) == 1.0
    assert nearest_neighbour_accuracy(real, real + 1e-6) == 0.0
