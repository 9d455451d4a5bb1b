"""What one unit adds to a motion."""

import numpy as np
import pytest

from numpy_cae.experiments.filters import energy_by_joint, responses_of
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import joint_slice
from numpy_cae.motion.joints import JOINTS


def test_a_first_layer_unit_adds_its_transposed_filter_on_both_frames():
    layer = ConvAutoencoder(filters=(3,), taps=5, dtype=np.float64).layers[0]
    units = np.repeat([[0.1, -0.2, 0.0], [0.5, 0.3, 0.4]], [95, 5], axis=0)
    added = responses_of([layer], units)
    frames = 2 * 3
    assert added.shape == (3, frames, 63)
    # Equation 2 on a raised unit: half of the increase of tanh⁻¹, on both frames, through W̃.
    gained = np.arctanh(0.5) - np.arctanh(units[:, 0].mean())
    w = layer.w[:, :, 0]
    expected = np.zeros((frames, 63))
    for frame in range(frames):
        for unpooled in (2, 3):
            tap = frame - unpooled + 2
            if 0 <= tap < 5:
                expected[frame] += gained / 2 * w[tap]
    np.testing.assert_allclose(added[0], expected, atol=1e-12)


def test_energy_is_shared_by_joints_and_silent_filters_are_left_out():
    responses = np.zeros((2, 10, 63))
    responses[0, 1, joint_slice("left_wrist")] = 3.0
    responses[0, 1, joint_slice("right_knee")] = 1.0
    responses[0, 1, 60:63] = 1.0
    (shares,) = energy_by_joint(responses)
    assert shares[JOINTS.index("left_wrist")] == pytest.approx(9 / 11)
    assert shares[-1] == pytest.approx(1 / 11)
