"""The manifold of clips: learned from motions of one rig, and sampled."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.manifold import learn_sequences
from numpy_cae.mocap import angles_of, load_motion
from numpy_cae.motion import cut_clips
from numpy_cae.training import SequenceSchedule

SHORT = SequenceSchedule(epochs=1, steps=3, batch=4, directions=4)


@pytest.fixture(scope="module")
def sequences():
    return [angles_of(make_take("walking", seed, 4.0, 50.0).motion) for seed in range(3)]


@pytest.fixture(scope="module")
def manifold(sequences):
    return learn_sequences(sequences, SHORT, hidden=6, latent=3)


def test_numbers_are_standardised_and_come_back(manifold, sequences):
    clips = cut_clips(sequences, 5)
    x = manifold.normalise(clips)
    assert x.dtype == np.float32
    varying = clips.std(axis=(0, 1)) >= 1e-3
    np.testing.assert_allclose(x.std(axis=(0, 1))[varying], 1, atol=1e-3)
    np.testing.assert_allclose(x.mean(axis=(0, 1)), 0, atol=1e-3)
    np.testing.assert_allclose(manifold.denormalise(x), clips, atol=1e-5)


def test_a_seed_determines_the_weights_and_a_report_changes_nothing(manifold, sequences):
    steps = []

    def report(state):
        steps.append((state.epoch, state.step))
        manifold.network.denoise(manifold.normalise(cut_clips(sequences)))

    read_apart = [pickle.loads(pickle.dumps(sequence)) for sequence in sequences]  # in processes
    again = learn_sequences(read_apart, SHORT, 0, report=report, hidden=6, latent=3)
    another = learn_sequences(sequences, SHORT, 1, hidden=6, latent=3)
    assert steps == [(0, 1), (0, 2), (1, 0)]
    for name, weight in manifold.network.weights.items():
        np.testing.assert_array_equal(weight, again.network.weights[name])
    latent_w = again.network.weights["latent_w"]
    assert not np.array_equal(latent_w, another.network.weights["latent_w"])


def test_different_rigs_are_not_learned_together(sequences):
    bent = replace(sequences[0], offsets=sequences[0].offsets[:, [1, 2, 0]])
    with pytest.raises(ValueError, match="different rigs"):
        learn_sequences([*sequences, bent], SHORT, hidden=6, latent=3)
    with pytest.raises(ValueError, match="no motions"):
        learn_sequences([])


def test_sampled_clips_stand_on_the_floor_and_are_written(manifold, tmp_path, run, error_of):
    for motion in manifold.sample(2, np.random.default_rng(0)):
        assert motion.rate == 25.0 and len(motion) == 50
        assert abs(motion.positions()[..., 1].min()) < 1e-9
    model, file = tmp_path / "m.npz", tmp_path / "o.bvh"
    manifold.save(model)
    run("sample", "-m", model, "-o", file)
    assert len(load_motion(file)) == 50
    assert "no --data" in error_of("sample", "-m", model, "-o", file, "--seconds", 3)
    assert "not a convolutional" in error_of("repair", file, "-m", model, "-o", file)
