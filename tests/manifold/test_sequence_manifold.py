"""The manifold of clips: learned from motions of one rig."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.manifold import learn_sequences
from numpy_cae.motion import angles_of, cut_clips, load_motion, write_bvh
from numpy_cae.motion.angles import AngleSequence
from numpy_cae.training import SequenceSchedule

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
