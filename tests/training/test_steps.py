"""The parts of a step: what is drawn, and how the weights descend."""

import numpy as np
import pytest

from numpy_cae.training import Adam, Stage, clip_norm, unit_directions
from numpy_cae.training.optimisers import Sgd
from numpy_cae.training.schedule import one_cycle, rate_at


def test_directions_have_length_one_and_no_preferred_direction():
    drawn = unit_directions(2000, 3, np.random.default_rng(0))
    assert drawn.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(drawn.mean(axis=0), 0, atol=0.05)
    np.testing.assert_allclose(drawn.T @ drawn / 2000, np.eye(3) / 3, atol=0.03)


def test_adam_and_momentum_are_their_definitions_as_sums_over_all_gradients():
    gradients = np.random.default_rng(0).normal(size=(20, 3)).astype(np.float32)
    w = np.ones(3, np.float32)
    moved = np.zeros(3)
    expected = np.ones(3)
    adam = Adam({"w": w})
    momentum = Sgd({"moved": moved}, momentum=0.9)
    for t in range(1, 21):
        adam.update([gradients[t - 1]], rate=0.02)
        momentum.update([gradients[t - 1]], rate=0.02)
        ages = np.arange(t)[::-1, None]
        mean = (0.1 * 0.9**ages * gradients[:t]).sum(axis=0) / (1 - 0.9**t)
        square = (0.01 * 0.99**ages * gradients[:t] ** 2).sum(axis=0) / (1 - 0.99**t)
        expected -= 0.02 * mean / (np.sqrt(square) + 1e-8)
    np.testing.assert_allclose(w, expected, atol=1e-5)
    sums = (1 - 0.9 ** np.arange(20, 0, -1)) / (1 - 0.9)  # of what each gradient still moves
    np.testing.assert_allclose(moved, -0.02 * sums @ gradients, atol=1e-6)
    assert {array.dtype for array in (w, *adam.means.values(), *adam.squares.values())} == {w.dtype}


def test_a_long_gradient_keeps_its_direction_and_a_short_one_its_values():
    row = np.array([3.0, 0.0])
    matrix = np.array([[0.0, 4.0]])
    assert clip_norm([row, matrix], 1.0) == pytest.approx(5)
    assert clip_norm([row, matrix], 2.0) == pytest.approx(1)
    np.testing.assert_allclose(row, [0.6, 0])
    np.testing.assert_allclose(matrix, [[0, 0.8]])
    for bound in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="above 0"):
            clip_norm([np.ones(2)], bound)


def test_a_one_cycle_rate_rises_to_its_peak_and_falls_to_nearly_zero():
    stage = Stage(epochs=10, rate=0.2, rate_schedule="one-cycle")
    rates = [rate_at(stage, epoch, step, 10) for epoch in range(10) for step in range(10)]
    assert np.argmax(rates) == 30
    assert rates[::30] == [one_cycle(0.2, share) for share in (0.0, 0.3, 0.6, 0.9)]
    assert all(np.diff(rates[:31]) > 0) and all(np.diff(rates[30:]) < 0)
    assert [one_cycle(0.2, x) for x in (1.0, 0.3001)] == pytest.approx([0.2e-5, 0.2], rel=1e-3)
