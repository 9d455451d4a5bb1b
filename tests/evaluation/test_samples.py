"""Measures of samples, on sets with known answers."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.evaluation import (
    diversity,
    gait_frequency,
    nearest_distance,
    nearest_neighbour_accuracy,
)
from numpy_cae.evaluation.samples import clip_distances
from numpy_cae.motion import JOINTS, body_positions


def drawn(count, seed, shift=0.0):
    return np.random.default_rng(seed).normal(shift, 1.0, (count, 2, 2))


def test_the_distance_is_the_root_mean_square():
    a, b = drawn(3, 0), drawn(4, 1)
    direct = np.sqrt(((a[:, None] - b[None]) ** 2).mean(axis=(2, 3)))
    assert np.allclose(clip_distances(a, b), direct)
    assert nearest_distance(a, b) == pytest.approx(direct.min(axis=1).mean())


def test_diversity_is_zero_for_copies_and_grows_with_the_spread():
    a = drawn(50, 0)
    assert diversity(np.repeat(a[:1], 5, axis=0)) == pytest.approx(0, abs=1e-7)
    assert diversity(3 * a) == pytest.approx(3 * diversity(a))
    assert diversity(a[:2]) == pytest.approx(clip_distances(a, a)[0, 1])


def test_the_two_sample_test_of_equal_different_and_copied_sets():
    real = drawn(400, 0)
    assert nearest_neighbour_accuracy(real, drawn(400, 1)) == pytest.approx(0.5, abs=0.05)
    assert nearest_neighbour_accuracy(real, drawn(400, 1, shift=8.0)) == 1.0
    assert nearest_neighbour_accuracy(real, real + 1e-6) == 0.0


def walker(stride, rate=25.0, frames=50, facing=0.7):
    """Two legs that swing against each other, `stride` times a second, in some direction."""
    t = np.arange(frames) / rate
    positions = np.zeros((frames, 20, 3))
    forward = np.array([np.sin(facing), 0.0, np.cos(facing)])
    left = np.array([np.cos(facing), 0.0, -np.sin(facing)])
    for sign, side in ((1, "left"), (-1, "right")):
        positions[:, JOINTS.index(f"{side}_hip")] = 0.1 * sign * left
        swing = 0.3 * sign * np.sin(2 * np.pi * stride * t + 0.4)
        positions[:, JOINTS.index(f"{side}_ankle")] = swing[:, None] * forward
    return positions + t[:, None, None] * forward


@pytest.mark.parametrize("stride", [0.75, 0.93, 1.2, 1.6])
def test_the_frequency_of_a_stride(stride):
    assert gait_frequency(walker(stride), 25.0) == pytest.approx(stride, rel=0.04)


def test_a_walk_has_a_stride_and_standing_has_none():
    take = make_take("walking", 3, seconds=5.0, style="brisk", rate=50.0)
    stride = gait_frequency(body_positions(take.motion)[100:], 50.0)
    assert 0.7 < stride < 1.3
    assert np.isnan(gait_frequency(np.zeros((50, 20, 3)), 25.0))
