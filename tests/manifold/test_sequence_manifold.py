"""A manifold of clips: made, saved, loaded, refused."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.manifold import (
    ModelFileError,
    learn_manifold,
    learn_sequences,
    load_manifold,
    load_sequences,
    save_manifold,
    save_sequences,
)
from numpy_cae.motion import angles_of, body_of, cut_clips, load_motion, write_bvh
from numpy_cae.motion.angles import AngleSequence
from numpy_cae.training import Schedule, SequenceSchedule, Stage

SHORT = SequenceSchedule(epochs=1, steps=3, batch=4, directions=4)


@pytest.fixture(scope="module")
def sequences():
    return [angles_of(make_take("walking", seed, 4.0, 50.0).motion) for seed in range(3)]


@pytest.fixture(scope="module")
def manifold(sequences):
    return learn_sequences(sequences, SHORT, hidden=6, latent=3, show_progress=False)


def test_numbers_are_standardised_and_come_back(manifold, sequences):
    clips = cut_clips(sequences, 5)
    x = manifold.normalise(clips)
    assert x.dtype == np.float32
    varying = clips.std(axis=(0, 1)) >= 1e-3
    assert np.allclose(x.std(axis=(0, 1))[varying], 1, atol=1e-3)
    assert np.abs(x.mean(axis=(0, 1))).max() < 1e-3
    assert np.allclose(manifold.denormalise(x), clips, atol=1e-5)


def test_the_same_seed_gives_the_same_bits(manifold, sequences):
    again = learn_sequences(sequences, SHORT, hidden=6, latent=3, show_progress=False)
    other = learn_sequences(sequences, SHORT, 1, hidden=6, latent=3, show_progress=False)
    for name, weight in manifold.network.weights.items():
        assert np.array_equal(weight, again.network.weights[name])
    assert not np.array_equal(
        manifold.network.weights["latent_w"], other.network.weights["latent_w"]
    )


def test_watching_changes_nothing(manifold, sequences):
    steps = []

    def watch(watched, step):
        steps.append(step)
        watched.network.denoise(watched.normalise(cut_clips(sequences)))

    again = learn_sequences(sequences, SHORT, 0, 6, 3, watch=watch, show_progress=False)
    assert steps == [0, 1, 2, 3]
    assert np.array_equal(manifold.network.weights["latent_w"], again.network.weights["latent_w"])


def test_a_file_holds_all_of_it(manifold, sequences, tmp_path):
    save_sequences(manifold, tmp_path / "seq.npz")
    loaded = load_sequences(tmp_path / "seq.npz")
    x = manifold.normalise(cut_clips(sequences)[:2])
    assert np.array_equal(loaded.network.denoise(x), manifold.network.denoise(x))
    assert loaded.settings == manifold.settings and loaded.table is manifold.table
    assert loaded.rate == 25.0
    assert np.array_equal(loaded.offsets, manifold.offsets)
    assert np.array_equal(loaded.motion(x[0]).positions(), manifold.motion(x[0]).positions())


def test_one_kind_of_model_is_refused_as_the_other(manifold, tmp_path):
    schedule = Schedule(layer=Stage(epochs=0), fine_tuning=Stage(epochs=0))
    take = body_of(make_take("walk", 0, 3.0, 30.0).motion)
    convolutional = learn_manifold([take], schedule, window=8, overlap=0, filters=[2, 2, 2])
    save_manifold(convolutional, tmp_path / "conv.npz")
    save_sequences(manifold, tmp_path / "seq.npz")
    with pytest.raises(ModelFileError, match=r"not a .*sequential.* but .*convolutional"):
        load_sequences(tmp_path / "conv.npz")
    with pytest.raises(ModelFileError, match=r"not a .*convolutional.* but .*sequential"):
        load_manifold(tmp_path / "seq.npz")


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("mean", np.zeros(53), "mean has shape"),
        ("deviation", np.zeros(54), "not above 0"),
        ("encoder_u", np.full((6, 18), np.nan, np.float32), "not finite"),
        ("table", np.array("another"), "none of this version"),
        ("state_w", np.zeros(3), "no matrix"),
    ],
)
def test_damaged_files_are_said(manifold, tmp_path, name, value, said):
    save_sequences(manifold, tmp_path / "seq.npz")
    with np.load(tmp_path / "seq.npz") as file:
        arrays = dict(file) | {name: value}
    np.savez(tmp_path / "seq.npz", **arrays)
    with pytest.raises(ModelFileError, match=said):
        load_sequences(tmp_path / "seq.npz")


def test_different_rigs_are_not_learned_together(sequences):
    bent = AngleSequence(
        sequences[0].numbers, sequences[0].table, sequences[0].offsets[:, [1, 2, 0]]
    )
    with pytest.raises(ValueError, match="different rigs"):
        learn_sequences([*sequences, bent], SHORT, hidden=6, latent=3)


def test_there_must_be_something_to_learn_from():
    with pytest.raises(ValueError, match="no motions"):
        learn_sequences([])


def test_a_sample_is_a_motion_that_stands_on_the_floor_and_can_be_written(manifold, tmp_path):
    clip = manifold.network.sample(1, np.random.default_rng(0))[0]
    motion = manifold.motion(clip)
    assert motion.rate == 25.0 and len(motion) == 50
    assert abs(motion.positions()[..., 1].min()) < 1e-9
    write_bvh(motion, tmp_path / "sample.bvh")
    assert np.allclose(
        load_motion(tmp_path / "sample.bvh", unit=1.0).positions(), motion.positions(), atol=1e-4
    )
