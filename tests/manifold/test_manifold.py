"""The manifold of motions: learned from takes, used on features of any length."""

import numpy as np
import pytest

from numpy_cae.evaluation import position_error
from numpy_cae.manifold import learn_manifold
from numpy_cae.motion import POSITIONS, bone_lengths
from numpy_cae.motion.features import TURN, VELOCITY
from numpy_cae.training import Schedule, Stage

TINY = {"window": 32, "overlap": 16, "filters": (4,), "taps": 3}
ONCE = Schedule(layer=Stage(epochs=1), fine_tuning=Stage(epochs=1, rate=0.01, alpha=0.0))


def test_the_mean_skeleton_is_the_mean_of_the_takes(walk_manifold, walk_takes):
    expected = np.mean([bone_lengths(take) for take in walk_takes], axis=0)
    np.testing.assert_allclose(walk_manifold.lengths, expected)


def test_normalised_features_have_mean_zero_and_one_scale_for_each_part(walk_manifold, walk_takes):
    features = np.concatenate([walk_manifold.features(take)[0] for take in walk_takes])
    x = walk_manifold.normalise(features)
    np.testing.assert_allclose(x.mean(axis=0), 0, atol=1e-6)
    for part in (POSITIONS, VELOCITY, TURN):
        assert np.sqrt(np.mean(x[:, part] ** 2)) == pytest.approx(0.25, rel=1e-4)
        assert len(set(walk_manifold.scale[part])) == 1
    np.testing.assert_allclose(walk_manifold.denormalise(x), features, atol=1e-6)


def test_constant_features_are_not_scaled_without_limit(walk_takes):
    up_and_down = 0.1 * np.sin(np.arange(64) / 5)[:, None, None] * [0.0, 1.0, 0.0]
    manifold = learn_manifold([walk_takes[0][:1] + up_and_down], ONCE, **TINY)
    assert manifold.scale[TURN] == pytest.approx(250)


def test_one_take_of_large_spread_limits_the_scale(walk_takes):
    """A person lying down has many times the spread of people standing."""
    flat = walk_takes[0] - walk_takes[0][:, :1]
    lying = np.stack([flat[..., 0], 0.2 + flat[..., 2], flat[..., 1]], axis=-1)
    manifold = learn_manifold([*walk_takes, lying], ONCE, **TINY)
    x = manifold.normalise(manifold.features(lying)[0])
    assert np.sqrt(np.mean(x**2)) == pytest.approx(0.5, rel=0.05)


def test_projection_of_the_ends_is_not_drawn_to_the_mean_pose(walk_manifold, walk_features):
    x = walk_manifold.normalise(walk_features[:64])
    zeros_around = walk_manifold.denormalise(walk_manifold.network.project(x[None])[0])
    ends = [0, 1, 2, 3, -4, -3, -2, -1]
    error = position_error(
        walk_manifold.project(walk_features[:64])[ends], walk_features[:64][ends]
    )
    assert error < position_error(zeros_around[ends], walk_features[:64][ends])


def test_a_projected_motion_is_nearer_to_the_truth_than_the_damaged_one(
    walk_manifold, walk_features
):
    zeroed = np.random.default_rng(0).random(walk_features.shape) < 0.5
    lost = np.where(zeroed, walk_manifold.mean_pose, walk_features)
    error = position_error(walk_manifold.project(lost), walk_features)
    assert error < 0.8 * position_error(lost, walk_features)


def test_a_seed_determines_the_manifold(walk_takes):
    weights = [
        learn_manifold(walk_takes, ONCE, seed, **TINY).network.layers[0].w for seed in (0, 0, 1)
    ]
    np.testing.assert_array_equal(weights[0], weights[1])
    assert np.any(weights[0] != weights[2])


@pytest.mark.parametrize(
    ("count", "window", "message"),
    [(0, 160, "no takes"), (1, 30, "expected a multiple of 8"), (1, 160, "nothing to learn")],
)
def test_unusable_takes_are_refused(walk_takes, count, window, message):
    still = [np.repeat(walk_takes[0][:1], 40, axis=0)] * count
    with pytest.raises(ValueError, match=message):
        learn_manifold(still, window=window, overlap=0)
