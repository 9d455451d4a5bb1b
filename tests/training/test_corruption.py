"""Corruption: a share of values, noise, and stretches of chains, at most three in a window."""

import numpy as np
import pytest

from numpy_cae.manifold.augmentation import damaged_chains, mirrored
from numpy_cae.motion import JOINTS
from numpy_cae.training import Stage
from numpy_cae.training.corruption import (
    MAX_STRETCH_FRAMES,
    _damage,
    corrupted_copy,
    damage_stretches,
    unpooling_mask,
)

X = np.random.default_rng(1).normal(size=(40, 160, 9)).astype(np.float32)


def test_only_points_of_chains_are_damaged_and_the_input_is_kept():
    rng = np.random.default_rng(0)
    x = rng.standard_normal((1000, 160, 12)).astype(np.float32)
    before = x.copy()
    stage = Stage(zeroed=0.0, displacement=0.2, chains=((0, 3, 6),))
    damaged = corrupted_copy(x, stage, rng)
    np.testing.assert_array_equal(x, before)
    assert damaged.dtype == x.dtype
    changed = damaged != x
    assert not changed[..., :3].any() and not changed[..., 9:].any()
    frames = changed.any(axis=2)
    assert 0.225 < np.mean(~frames.any(axis=1)) < 0.275  # a quarter has no stretch
    assert frames.sum(axis=1).max() <= 3 * MAX_STRETCH_FRAMES
    short = damage_stretches(x[:, :8], [(0, 3, 6)], 0.2, rng)
    assert short.shape == (1000, 8, 12) and np.all(np.isfinite(short))


class Drawn:
    """In place of a generator: one kind of damage, and numbers that make the shift known."""

    def __init__(self, kind):
        self.kind = kind

    def integers(self, count):
        assert self.kind < count == 5
        return self.kind

    def standard_normal(self, count):
        return np.arange(1.0, count + 1)

    def random(self):
        return 0.25


@pytest.mark.parametrize(("start", "stop"), [(3, 6), (0, 4), (5, 8)])
def test_each_kind_of_damage(start, stop):
    """A chain of two points with its base at channel 3, damaged in the frames start to stop."""
    x = np.random.default_rng(0).normal(size=(8, 12))
    base, points = x[:, 3:6], x[:, 6:].reshape(8, 2, 3)
    before, after = points[max(start - 1, 0)], points[min(stop, 7)]
    share = np.arange(1, stop - start + 1)[:, None, None] / (stop - start + 1)
    own_base = base[start:stop] - base[max(start - 1, 0)]
    expected = (
        np.zeros((stop - start, 2, 3)),
        np.broadcast_to(before, (stop - start, 2, 3)),
        own_base[:, None] + before,
        (1 - share) * before + share * after,
        points[start:stop] + 0.2 * np.array([1, 2, 3]) / 2 * [[0.5], [1.0]],
    )
    for kind, right in enumerate(expected):
        damaged = x.copy()
        _damage(damaged, [3, 6, 9], slice(start, stop), 0.2, Drawn(kind))
        inside = damaged[start:stop, 6:].reshape(-1, 2, 3)
        np.testing.assert_allclose(inside, right, atol=1e-12, err_msg=f"kind {kind}")
        damaged[start:stop, 6:] = x[start:stop, 6:]
        np.testing.assert_array_equal(damaged, x)


def test_noise_has_another_deviation_in_each_window_and_is_drawn_for_each_value():
    stage, x = Stage(noise=0.5, zeroed=0.0), np.zeros((30, 80, 3), np.float32)
    noise = corrupted_copy(x, stage, np.random.default_rng(0))
    assert noise.dtype == np.float32
    deviations = noise.std(axis=(1, 2))
    assert deviations.max() < 0.6
    assert deviations.min() < 0.1 < 0.4 < deviations.max()
    for axis in (1, 2):  # not the same in every frame, nor in every channel
        assert noise.std(axis=axis).mean() > deviations.mean() / 2


def test_chains_have_every_joint_and_their_base_is_no_part_of_them():
    chains = damaged_chains()
    assert {channel for _, *points in chains for channel in points} == set(range(3, 60, 3))
    assert all(base not in points for base, *points in chains)


def test_mirroring_twice_is_the_identity_and_exchanges_the_hands():
    positions = np.random.default_rng(0).normal(size=(4, 20, 3))
    np.testing.assert_array_equal(mirrored(mirrored(positions)), positions)
    left, right = JOINTS.index("left_wrist"), JOINTS.index("right_wrist")
    np.testing.assert_array_equal(mirrored(positions)[:, left, 1:], positions[:, right, 1:])


@pytest.mark.parametrize("rescaled", [False, True])
@pytest.mark.parametrize("zeroed", [(0.0, 0.0), (0.1, 0.1), (0.5, 0.5), (0.2, 0.8), (1.0, 1.0)])
def test_a_share_p_is_zeroed_and_the_others_are_kept_or_divided_by_1_minus_p(zeroed, rescaled):
    before, (low, high) = X.copy(), zeroed
    stage = Stage(zeroed=zeroed if low < high else low, rescaled=rescaled and high < 1)
    corrupted = corrupted_copy(X, stage, np.random.default_rng(0))
    assert corrupted.dtype == np.float32
    np.testing.assert_array_equal(X, before)
    lost = corrupted == 0
    shares = lost.mean(axis=(1, 2))  # of 1440 values a window
    assert low - 0.05 < shares.min() < low + 0.1 and high - 0.1 < shares.max() < high + 0.05
    assert lost.mean() == pytest.approx((low + high) / 2, abs=0.01 if low == high else 0.1)
    for window, kept, share in zip(corrupted / X, ~lost, shares, strict=True):
        factor = 1 / (1 - share) if stage.rescaled else 1.0
        assert np.ptp(window[kept], axis=0) < 1e-5 if kept.any() else share == 1
        np.testing.assert_allclose(window[kept], factor, rtol=0.15 if stage.rescaled else 1e-6)


def test_a_mask_is_as_often_true_as_false():
    mask = unpooling_mask(np.ones((10, 400, 3)), 20, np.random.default_rng(0))
    assert mask.shape == (10, 200, 20) and mask.dtype == bool
    assert mask.mean() == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("p", [1.5, (1.2, 1.5)])
def test_a_probability_above_one_is_an_error(p):
    with pytest.raises(ValueError, match="expected a probability"):
        corrupted_copy(X, Stage(zeroed=p), np.random.default_rng(0))
