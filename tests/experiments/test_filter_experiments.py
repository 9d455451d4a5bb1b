"""What one unit adds to a motion."""

import numpy as np
import pytest

from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.filters import Responses, responses_of
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import joint_slice


def test_a_first_layer_unit_adds_its_transposed_filter_on_both_frames():
    layer = ConvAutoencoder(filters=(3,), taps=5, dtype=np.float64).layers[0]
    units = np.repeat([[0.1, -0.2, 0.0], [0.5, 0.3, 0.4]], [95, 5], axis=0)
    added = responses_of([layer], units).added
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


def one_filter(*movements):
    """A filter that moves features by so much in so many frames, and one that is silent."""
    added = np.zeros((2, 10, 63))
    for features, frames, size in movements:
        added[0, frames, features] = size
    return Responses(added)


def test_joints_and_frames_are_counted_by_energy():
    wrist, knee = joint_slice("left_wrist"), joint_slice("right_knee")
    alike = one_filter((wrist, slice(2, 6), 1.0), (knee, slice(2, 6), 1.0))
    assert alike.active.tolist() == [True, False]
    assert alike.joints() == pytest.approx([2.0])
    assert alike.frames() == pytest.approx([4.0])
    assert sorted(alike.by_joint()[0])[-2:] == pytest.approx([0.5, 0.5])
    uneven = one_filter((wrist, 1, 3.0), (knee, 1, 1.0), (slice(60, 63), 1, 1.0))
    assert uneven.by_joint()[0, -1] == pytest.approx(1 / 11)
    assert one_filter((slice(60, 63), 1, 1.0)).joints() == [0]
    # Energies 9 and 1 of ten: 1 / (0.81 + 0.01).
    assert uneven.joints() == pytest.approx([1 / 0.82])


def test_the_untrained_network_is_the_one_before_training(small_manifold, result_of):
    before = untrained(small_manifold, small_manifold.settings["seed"]).network
    w, old = small_manifold.network.layers[0].w, before.layers[0].w
    assert 0.5 < np.corrcoef(w.ravel(), old.ravel())[0, 1] < 1  # a few epochs change it little
    result = result_of("filters")
    assert [row[1] for row in result.tables[0].rows] == [12, 16]
    assert len(result.claims) == 4
