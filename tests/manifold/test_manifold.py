"""The manifold: learned from takes, kept in a file, used on motions of any rig and length."""

import json

import numpy as np
import pytest

from numpy_cae.manifold import (
    ModelFileError,
    MotionManifold,
    learn_manifold,
    load_manifold,
    save_manifold,
)
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


def test_where_nobody_turned_a_turn_is_not_blown_up(manifold):
    """Nobody in these takes turns: what a turn is multiplied by stays within reason."""
    assert manifold.scale[TURN] == pytest.approx(250)


def test_one_loud_take_does_not_drown_the_others():
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


def test_projection_brings_a_damaged_motion_nearer_to_the_truth(manifold):
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


def test_a_model_file_holds_everything_and_no_pickle(manifold, tmp_path):
    file = tmp_path / "model.npz"
    save_manifold(manifold, file)
    loaded = load_manifold(file)
    assert list(tmp_path.iterdir()) == [file]
    features, _ = manifold.features(take(5).positions())
    np.testing.assert_array_equal(loaded.project(features), manifold.project(features))
    assert loaded.settings == json.loads(json.dumps(manifold.settings))
    assert loaded.settings["schedule"]["layer"]["epochs"] == 6
    with np.load(file, allow_pickle=False) as arrays:
        assert all(arrays[name].dtype != object for name in arrays.files)


def spoiled(manifold, file, **changes):
    save_manifold(manifold, file)
    with np.load(file) as archive:
        arrays = {name: archive[name] for name in archive.files}
    arrays.update(changes)
    np.savez(file, **{name: array for name, array in arrays.items() if array is not None})


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"format": np.array("another")}, "another"),
        ({"w1": np.zeros((5, 62, 12), np.float32)}, "w1 has shape"),
        ({"b2": None}, "b2"),
        ({"mean_pose": np.full(63, np.nan)}, "mean_pose"),
        ({"joints": np.array(["tail"])}, "joints"),
        ({"settings": np.array("{")}, ""),
    ],
)
def test_a_model_file_that_does_not_fit_is_refused(manifold, tmp_path, changes, said):
    file = tmp_path / "model.npz"
    spoiled(manifold, file, **changes)
    with pytest.raises(ModelFileError, match=r"model\.npz") as error:
        load_manifold(file)
    assert said in str(error.value)


@pytest.mark.parametrize("content", [b"", b"not a model", b"PK\x03\x04 broken", None])
def test_what_is_no_model_file_is_refused(tmp_path, content):
    file = tmp_path / "model.npz"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(ModelFileError, match=r"model\.npz"):
        load_manifold(file)


def test_a_pickle_in_a_model_file_is_not_opened(manifold, tmp_path):
    file = tmp_path / "model.npz"
    spoiled(manifold, file, scale=np.array({"a": 1}, dtype=object))
    with pytest.raises(ModelFileError):
        load_manifold(file)


def test_learning_says_what_it_cannot_use():
    with pytest.raises(ValueError, match="no takes"):
        learn_manifold([])
    with pytest.raises(ValueError, match="window is 30, expected a multiple of 8"):
        learn_manifold([take(0).positions()], window=30, overlap=0)
    still = np.repeat(take(0).positions()[:1], 40, axis=0)
    still[:, 0, 2] = 0
    with pytest.raises(ValueError, match="nothing to learn"):
        learn_manifold([still], show_progress=False)


def test_a_manifold_can_be_put_together_by_hand():
    from numpy_cae.models import ConvAutoencoder

    by_hand = MotionManifold(ConvAutoencoder(), np.zeros(63), np.ones(63), LENGTHS)
    assert by_hand.project(np.zeros((5, 63))).shape == (5, 63)
