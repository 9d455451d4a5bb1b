"""Damage of stretches: only chains are damaged, in at most three stretches of a window."""

import numpy as np

from numpy_cae.manifold.augmentation import damaged_chains, mirrored
from numpy_cae.motion import JOINTS
from numpy_cae.training.corruption import LONGEST, damage_stretches


def test_only_points_of_chains_are_damaged_and_the_input_is_kept():
    rng = np.random.default_rng(0)
    x = rng.standard_normal((200, 160, 12)).astype(np.float32)
    before = x.copy()
    damaged = damage_stretches(x, [(0, 3, 6)], 0.2, rng)
    np.testing.assert_array_equal(x, before)
    assert damaged.dtype == x.dtype
    changed = damaged != x
    assert not changed[..., :3].any()
    assert not changed[..., 9:].any()
    frames = changed.any(axis=2)
    assert 0.1 < np.mean(~frames.any(axis=1)) < 0.5  # a quarter has no stretch
    assert frames.sum(axis=1).max() <= 3 * LONGEST
    short = damage_stretches(x[:, :8], [(0, 3, 6)], 0.2, rng)
    assert short.shape == (200, 8, 12)
    assert np.all(np.isfinite(short))


def test_chains_have_every_joint_and_their_base_is_no_part_of_them():
    chains = damaged_chains()
    assert {channel for _, *points in chains for channel in points} == set(range(3, 60, 3))
    assert all(base not in points for base, *points in chains)


def test_mirroring_twice_is_the_identity_and_exchanges_the_hands():
    positions = np.random.default_rng(0).normal(size=(4, 20, 3))
    np.testing.assert_array_equal(mirrored(mirrored(positions)), positions)
    left, right = JOINTS.index("left_wrist"), JOINTS.index("right_wrist")
    np.testing.assert_array_equal(mirrored(positions)[:, left, 1:], positions[:, right, 1:])
