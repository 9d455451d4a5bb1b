"""What one unit adds: of the first layer its filter, of an upper layer what the lower ones make."""

import numpy as np
import pytest

from numpy_cae.experiments.filters.responses import LIMBS, Responses, decoded, encoded, responses_of
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import joint_slice


def test_a_first_layer_unit_adds_its_filter_turned_round_on_both_frames():
    layer = ConvAutoencoder(filters=(3,), taps=5, dtype=np.float64).layers[0]
    units = np.repeat([[0.1, -0.2, 0.0], [0.5, 0.3, 0.4]], [95, 5], axis=0)
    added = responses_of([layer], units).added
    frames = 2 * 3
    assert added.shape == (3, frames, 63)
    # Equation 2 on a raised unit: half of what tanh⁻¹ gains, on both frames, through W̃.
    gained = np.arctanh(0.5) - np.arctanh(units[:, 0].mean())
    w = layer.w[:, :, 0]
    expected = np.zeros((frames, 63))
    for frame in range(frames):
        for unpooled in (2, 3):
            tap = frame - unpooled + 2
            if 0 <= tap < 5:
                expected[frame] += gained / 2 * w[tap]
    np.testing.assert_allclose(added[0], expected, atol=1e-12)


def test_up_and_down_is_what_the_network_does():
    network = ConvAutoencoder(filters=(6, 8), taps=5)
    x = np.random.default_rng(0).normal(0, 0.2, size=(2, 16, 63)).astype(np.float32)
    every = encoded(network.layers, x)
    np.testing.assert_allclose(every[-1], network.encode(x), atol=1e-5)
    np.testing.assert_allclose(decoded(network.layers, every[-1]), network.project(x), atol=1e-5)


def one_filter(*movements):
    """A filter that moves features by so much in so many frames, and one that is silent."""
    added = np.zeros((2, 10, 63))
    for features, frames, size in movements:
        added[0, frames, features] = size
    return Responses(added)


def test_joints_and_frames_are_counted_by_hand():
    wrist, knee = joint_slice("left_wrist"), joint_slice("right_knee")
    alike = one_filter((wrist, slice(2, 6), 1.0), (knee, slice(2, 6), 1.0))
    assert alike.heard.tolist() == [True, False]
    assert alike.joints() == pytest.approx([2.0])
    assert alike.frames() == pytest.approx([4.0])
    limbs = dict(zip(LIMBS, alike.by_limb()[0], strict=True))
    assert limbs["left arm"] == limbs["right leg"] == pytest.approx(0.5)
    uneven = one_filter((wrist, 1, 3.0), (knee, 1, 1.0), (slice(60, 63), 1, 1.0))
    assert uneven.by_limb()[0, LIMBS.index("path")] == pytest.approx(1 / 11)
    assert one_filter((slice(60, 63), 1, 1.0)).joints() == [0]
    # Energies 9 and 1 of ten: 1 / (0.81 + 0.01).
    assert uneven.joints() == pytest.approx([1 / 0.82])


def test_what_moves_with_its_parent_and_what_goes_on_in_time():
    added = np.random.default_rng(1).normal(size=(40, 30, 63))
    drawn = Responses(added.copy())
    assert abs(np.mean(drawn.temporal())) < 0.05
    assert np.mean(drawn.between_joints()) < 0.15
    added[:, :, :60] = np.tile(added[:, :, :3], 20)
    added[:] = added[:, :1]
    whole = Responses(added)
    np.testing.assert_allclose(whole.temporal(), 1)
    np.testing.assert_allclose(whole.between_joints(), 1)
