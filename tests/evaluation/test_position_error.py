"""The position error, in centimetres, and jitter, in m/s²."""

import numpy as np
import pytest

from numpy_cae.evaluation import jitter, position_error
from numpy_cae.motion import POSITIONS, joint_slice


@pytest.mark.parametrize("rate", [30.0, 120.0])
def test_a_falling_body_has_the_acceleration_of_gravity(rate):
    t = np.arange(20) / rate
    positions = np.zeros((20, 2, 3))
    positions[:, :, 1] = -9.81 / 2 * t[:, None] ** 2
    positions[:, :, 0] = 3.0 * t[:, None]
    assert jitter(positions, rate) == pytest.approx(9.81)


def test_white_noise_grows_with_the_square_of_the_rate():
    noise = 0.01 * np.random.default_rng(0).normal(size=(5000, 4, 3))
    # Second differences of noise have variance 1 + 4 + 1 = 6 along each axis; the mean length of a
    # normal vector in space is σ · 2 · √(2 / π).
    assert jitter(noise, 30.0) == pytest.approx(
        0.01 * np.sqrt(6) * 2 * np.sqrt(2 / np.pi) * 900, rel=0.02
    )


def test_fewer_than_three_frames_are_refused():
    with pytest.raises(ValueError, match=r"\(2, 20, 3\), expected \(3 frames or more"):
        jitter(np.zeros((2, 20, 3)), 30.0)
    with pytest.raises(ValueError, match="expected"):
        jitter(np.zeros((10, 60)), 30.0)


def test_velocities_and_padded_frames_do_not_count():
    truth = np.zeros((2, 8, 63))
    off = truth.copy()
    off[..., POSITIONS.stop :] = 5.0
    off[:, 6:] = 7.0
    off[:, :6, 0] = 0.03
    real = np.arange(8) < 6
    measured = position_error(off, truth, np.stack([real, real]))
    assert measured == pytest.approx(3 / np.sqrt(60))


def test_one_joint_can_be_counted_alone():
    truth = np.zeros((8, 63))
    off = truth.copy()
    off[:, joint_slice("left_wrist")] = 0.02
    assert position_error(off, truth, joint="left_wrist") == pytest.approx(2.0)
    assert position_error(off, truth, joint="right_wrist") == 0.0
