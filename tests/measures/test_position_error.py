"""The error in centimetres: only positions, only real frames."""

import numpy as np
import pytest

from numpy_cae.measures import position_error
from numpy_cae.motion import POSITIONS, joint_slice


def test_a_centimetre_everywhere_is_one():
    truth = np.random.default_rng(0).normal(size=(2, 8, 63))
    assert position_error(truth + 0.01, truth) == pytest.approx(1.0)


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
