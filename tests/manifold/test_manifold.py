"""The manifold of motions: learned from takes, used on features of any length."""

import numpy as np
import pytest

from numpy_cae.manifold import learn_manifold
from numpy_cae.measures import position_error
from numpy_cae.motion import JOINTS, POSITIONS, TURN, VELOCITY, bone_lengths, fit_motion
from numpy_cae.motion.retarget.fit import body_skeleton
from numpy_cae.training import Schedule, Stage

LENGTHS = np.array([0, 12, 12, 30] + [13, 5, 25, 23] * 2 + [10, 40, 41, 13] * 2) / 100


def take(seed, frames=70, size=1.0):
    """A body whose knees and elbows swing, on bones `size` times the usual ones."""
    rng = np.random.default_rng(seed)
    still = fit_motion(np.zeros((frames, 20, 3)), 0 * LENGTHS, 30.0)
    skeleton = body_skeleton(LENGTHS * size)
    phase = np.arange(frames) / 5 + rng.uniform(0, 6)
    rotations = still.rotations.copy()
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for joint, swing in (("knee", 0.5), ("hip", 0.4), ("shoulder", 0.3), ("elbow", 0.4)):
            half = swing * rng.uniform(0.7, 1.3) * sign * np.sin(phase) / 2
            place = JOINTS.index(f"{side}_{joint}")
            rotations[:, place, 0], rotations[:, place, 3] = np.sin(half), np.cos(half)
    translations = np.repeat(skeleton.offsets[None], frames, axis=0)
    translations[:, 0] = np.stack([0 * phase, 0.95 * size + 0 * phase, 0.04 * phase], axis=-1)
    return type(still)(skeleton, 30.0, rotations, translations, unit=0.01)


QUICK = Schedule(layer=Stage(epochs=6), fine_tuning=Stage(10, 0.1, 0.9, 0.0))


@pytest.fixture(scope="module")
def manifold():
    takes = [take(seed, size=0.9 + 0.02 * seed).positions() for seed in range(12)]
    return learn_manifold(
        takes, QUICK, window=32, overlap=16, filters=(12, 16), taps=5, show_progress=False
    )


def test_the_mean_skeleton_is_the_mean_of_the_takes(manifold):
    expected = np.mean(
        [bone_lengths(take(s, size=0.9 + 0.02 * s).positions()) for s in range(12)], 0
    )
    np.testing.assert_allclose(manifold.lengths, expected)


def test_normalised_features_have_mean_zero_and_one_scale_a_kind(manifold):
    features = [manifold.features(take(s, size=0.9 + 0.02 * s).positions())[0] for s in range(12)]
    x = manifold.normalise(np.concatenate(features))
    np.testing.assert_allclose(x.mean(axis=0), 0, atol=1e-6)
    assert np.sqrt(np.mean(x[:, POSITIONS] ** 2)) == pytest.approx(0.25, rel=1e-4)
    assert len(set(manifold.scale[POSITIONS])) == len(set(manifold.scale[VELOCITY])) == 1
    np.testing.assert_allclose(manifold.denormalise(x), np.concatenate(features), atol=1e-6)


def test_constant_features_are_not_scaled_without_limit(manifold):
    """Nobody in these takes turns: what a turn is multiplied by stays within reason."""
    assert manifold.scale[TURN] == pytest.approx(250)


def test_one_take_of_large_spread_limits_the_scale():
    """A person lying down has many times the spread of people standing."""
    takes = [take(seed).positions() for seed in range(20)]
    flat = takes[0] - takes[0][:, :1]
    lying = np.stack([flat[..., 0], 0.2 + flat[..., 2], flat[..., 1]], axis=-1)
    once = Schedule(layer=Stage(epochs=1), fine_tuning=Stage(1, 0.01, 0.9, 0.0))
    few = {"window": 32, "overlap": 16, "filters": (4,), "taps": 3, "show_progress": False}
    manifold = learn_manifold([*takes, lying], once, **few)
    x = manifold.normalise(manifold.features(lying)[0])
    assert np.sqrt(np.mean(x**2)) == pytest.approx(0.5, rel=0.05)


@pytest.mark.parametrize("frames", [1, 3, 32, 61])
def test_projection_takes_any_length(manifold, frames):
    features, _ = manifold.features(take(1, frames=61).positions())
    projected = manifold.project(features[:frames])
    assert projected.shape == (frames, 63)
    assert np.all(np.isfinite(projected))


def test_projection_of_the_ends_does_not_fall_back_to_the_mean_pose(manifold):
    """What lies beyond a clip is its own first and last frame, not zeros."""
    features, _ = manifold.features(take(4, frames=64).positions())
    bare = manifold.denormalise(manifold.network.project(manifold.normalise(features)[None])[0])
    ends = [0, 1, 2, 3, -4, -3, -2, -1]
    error = position_error(manifold.project(features)[ends], features[ends])
    assert error < position_error(bare[ends], features[ends])


def test_a_projected_motion_is_nearer_to_the_truth_than_the_damaged_one(manifold):
    features, _ = manifold.features(take(99).positions())
    rng = np.random.default_rng(0)
    lost = np.where(rng.random(features.shape) < 0.5, manifold.mean_pose, features)
    assert position_error(manifold.project(lost), features) < 0.8 * position_error(lost, features)


def test_same_seed_same_manifold_to_the_bit(manifold):
    takes = [take(seed, size=0.9 + 0.02 * seed).positions() for seed in range(12)]
    again = learn_manifold(
        takes, QUICK, window=32, overlap=16, filters=(12, 16), taps=5, show_progress=False
    )
    for one, two in zip(manifold.network.layers, again.network.layers, strict=True):
        np.testing.assert_array_equal(one.w, two.w)
        np.testing.assert_array_equal(one.b, two.b)


def test_unusable_takes_are_refused():
    with pytest.raises(ValueError, match="no takes"):
        learn_manifold([])
    with pytest.raises(ValueError, match="window is 30, expected a multiple of 8"):
        learn_manifold([take(0).positions()], window=30, overlap=0)
    still = np.repeat(take(0).positions()[:1], 40, axis=0)
    still[:, 0, 2] = 0
    with pytest.raises(ValueError, match="nothing to learn"):
        learn_manifold([still], show_progress=False)
