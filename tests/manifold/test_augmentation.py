"""Damage like that of motion files: stretches of chains, at most three in a window, and noise."""

import numpy as np
import pytest

from numpy_cae.manifold.augmentation import (
    DAMAGES,
    MAX_STRETCH_FRAMES,
    FileDamage,
    damage_stretch,
    damage_stretches,
    list_chains,
    mirror,
)
from numpy_cae.motion import JOINTS
from numpy_cae.training import Stage
from numpy_cae.training.corruption import corrupt


def test_only_points_of_chains_are_damaged_and_the_input_is_kept():
    x = np.random.default_rng(0).standard_normal((1000, 160, 12)).astype(np.float32)
    before = x.copy()
    damaged = damage_stretches(x, [(0, 3, 6)], 0.2, np.random.default_rng(1))
    np.testing.assert_array_equal(x, before)
    assert damaged.dtype == x.dtype
    changed = damaged != x
    assert not changed[..., :3].any() and not changed[..., 9:].any()
    frames = changed.any(axis=2)
    assert 0.225 < np.mean(~frames.any(axis=1)) < 0.275  # a quarter has no stretch
    assert frames.sum(axis=1).max() <= 3 * MAX_STRETCH_FRAMES


def test_windows_shorter_than_a_stretch_are_damaged_too():
    x = np.random.default_rng(0).standard_normal((1000, 8, 12)).astype(np.float32)
    damaged = damage_stretches(x, [(0, 3, 6)], 0.2, np.random.default_rng(1))
    assert damaged.shape == (1000, 8, 12) and np.all(np.isfinite(damaged))


class FixedDraws:
    """In place of a generator: one kind of damage, and numbers that make the shift known."""

    def __init__(self, damage):
        self.damage = damage

    def integers(self, count):
        assert count == len(DAMAGES)
        return DAMAGES.index(self.damage)

    def standard_normal(self, count):
        return np.arange(1.0, count + 1)

    def random(self):
        return 0.25


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize(("start", "stop"), [(3, 6), (0, 4), (5, 8)])
def test_each_kind_of_damage(start, stop, damage):
    """A chain of two points with its base at channel 3, damaged in the frames start to stop."""
    x = np.random.default_rng(0).normal(size=(8, 12))
    base = x[:, 3:6]
    points = x[:, 6:].reshape(8, 2, 3)
    before = points[max(start - 1, 0)]
    after = points[min(stop, 7)]
    share = np.arange(1, stop - start + 1)[:, None, None] / (stop - start + 1)
    base_moves = base[start:stop] - base[max(start - 1, 0)]
    expected = {
        "zeroed": np.zeros((stop - start, 2, 3)),
        "frozen": np.broadcast_to(before, (stop - start, 2, 3)),
        "frozen relative to the base": base_moves[:, None] + before,
        "interpolated": (1 - share) * before + share * after,
        "displaced": points[start:stop] + 0.2 * np.array([1, 2, 3]) / 2 * [[0.5], [1.0]],
    }
    damaged = x.copy()
    damage_stretch(damaged, [3, 6, 9], slice(start, stop), 0.2, FixedDraws(damage))
    inside = damaged[start:stop, 6:].reshape(-1, 2, 3)
    np.testing.assert_allclose(inside, expected[damage], atol=1e-12)
    damaged[start:stop, 6:] = x[start:stop, 6:]
    np.testing.assert_array_equal(damaged, x)


def test_noise_has_another_deviation_in_each_window_and_is_drawn_for_each_value():
    stage = Stage(zeroed=0.0, damage=FileDamage(displacement=0.0, noise=0.5))
    noise = corrupt(np.zeros((30, 80, 63), np.float32), stage, np.random.default_rng(0))
    assert noise.dtype == np.float32
    deviations = noise.std(axis=(1, 2))
    assert deviations.max() < 0.6
    assert deviations.min() < 0.1 < 0.4 < deviations.max()
    for axis in (1, 2):  # not the same in every frame, nor in every channel
        assert noise.std(axis=axis).mean() > deviations.mean() / 2


def test_the_damage_of_a_stage_is_a_dataclass():
    with pytest.raises(ValueError, match=r"damage is .* expected a dataclass"):
        Stage(damage=lambda x, rng: x)


def test_chains_have_every_joint_and_their_base_is_no_part_of_them():
    chains = list_chains()
    assert {channel for _, *points in chains for channel in points} == set(range(3, 60, 3))
    assert all(base not in points for base, *points in chains)


def test_mirroring_twice_is_the_identity_and_exchanges_the_hands():
    positions = np.random.default_rng(0).normal(size=(4, 20, 3))
    np.testing.assert_array_equal(mirror(mirror(positions)), positions)
    left = JOINTS.index("left_wrist")
    right = JOINTS.index("right_wrist")
    np.testing.assert_array_equal(mirror(positions)[:, left, 1:], positions[:, right, 1:])
