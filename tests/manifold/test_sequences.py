"""The manifold of clips: learned from motions of one rig, and used on motions of any length."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.manifold import (
    learn_sequences,
    project_sequence,
    repair_sequence,
    sample_sequence,
    save_manifold,
)
from numpy_cae.manifold.long_sequences import clip_starts
from numpy_cae.motion import angles_of, body_positions, cut_clips, load_motion, write_bvh
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


def test_the_same_seed_gives_the_same_bits_and_watching_changes_nothing(manifold, sequences):
    steps = []

    def watch(watched, step):
        steps.append(step)
        watched.network.denoise(watched.normalise(cut_clips(sequences)))

    again = learn_sequences(sequences, SHORT, 0, 6, 3, watch=watch, show_progress=False)
    other = learn_sequences(sequences, SHORT, 1, 6, 3, show_progress=False)
    assert steps == [0, 1, 2, 3]
    for name, weight in manifold.network.weights.items():
        assert np.array_equal(weight, again.network.weights[name])
    assert not np.array_equal(
        manifold.network.weights["latent_w"], other.network.weights["latent_w"]
    )


def test_different_rigs_are_not_learned_together(sequences):
    bent = replace(sequences[0], offsets=sequences[0].offsets[:, [1, 2, 0]])
    with pytest.raises(ValueError, match="different rigs"):
        learn_sequences([*sequences, bent], SHORT, hidden=6, latent=3)
    with pytest.raises(ValueError, match="no motions"):
        learn_sequences([])


def test_a_sampled_clip_stands_on_the_floor(manifold):
    motion = manifold.motion(manifold.network.sample(1, np.random.default_rng(0))[0])
    assert motion.rate == 25.0 and len(motion) == 50
    assert abs(motion.positions()[..., 1].min()) < 1e-9


class Perfect:
    """A network that reproduces what it reads."""

    def __init__(self, network):
        self.weights = network.weights

    def denoise(self, x):
        return x


def walked(seconds, rate=25.0):
    return make_take("walking", 5, seconds, rate).motion


@pytest.mark.parametrize("frames", [1, 7, 49, 50, 51, 99, 100, 140])
def test_clips_cover_every_frame_and_a_perfect_network_changes_nothing(manifold, frames):
    begin = clip_starts(frames, min(frames, 50))
    assert begin[0] == 0 and begin[-1] + min(frames, 50) == frames
    assert (np.diff(begin) <= 25).all()
    whole = angles_of(walked(6.0))
    cut = replace(whole, numbers=whole.numbers[:frames])
    perfect = replace(manifold, network=Perfect(manifold.network), offsets=cut.offsets)
    made = body_positions(project_sequence(perfect, cut))
    asked = body_positions(walked(6.0))[:frames]
    # Bones are means over the take, and the numbers float32.
    assert np.abs(made - asked).max() < 0.03


def test_the_rig_rate_unit_and_length_stay(manifold):
    motion = replace(walked(3.1, 120.0), unit=0.01)
    made = repair_sequence(motion, manifold)
    assert (len(made), made.rate, made.unit) == (len(motion), motion.rate, motion.unit)
    assert made.skeleton.names == motion.skeleton.names


@pytest.mark.parametrize("frames", [1, 50, 51, 130])
def test_samples_of_any_length(manifold, frames, monkeypatch):
    monkeypatch.setattr("numpy_cae.manifold.long_sequences.CANDIDATES", 3)
    made = sample_sequence(manifold, frames, np.random.default_rng(0))
    positions = body_positions(made)
    assert positions.shape == (frames, 20, 3) and np.isfinite(positions).all()
    again = sample_sequence(manifold, frames, np.random.default_rng(0))
    np.testing.assert_array_equal(again.rotations, made.rotations)
    with pytest.raises(ValueError, match="frames is 0"):
        sample_sequence(manifold, 0, np.random.default_rng(0))


def test_from_the_command_line(manifold, tmp_path, monkeypatch, run, error_of):
    monkeypatch.setattr("numpy_cae.manifold.long_sequences.CANDIDATES", 3)
    model, file, out = tmp_path / "m.npz", tmp_path / "a.bvh", tmp_path / "o.bvh"
    save_manifold(manifold, model)
    write_bvh(walked(3.0, 60.0), file)
    run("repair", file, "-m", model, "-o", out)
    assert len(load_motion(out)) == 180
    run("sample", "-m", model, "-o", out, "--seconds", 3)
    assert len(load_motion(out)) == 75
    assert "not a convolutional" in error_of("compare", file, file, "-m", model)
