"""jang2018's network: the gradients of its whole loss, and the conventions of its decoder."""

from copy import copy

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae import ops
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import unit_directions
from numpy_cae.verify import check_gradients


def drawn_model(rng, features=3, hidden=4, latent=2, dtype=np.float64, scale=0.6, **more):
    """A small network whose biases are not zero."""
    model = SequentialAutoencoder(features, hidden, latent, rng, dtype, **more)
    for name, weight in model.weights.items():
        model.weights[name] = rng.normal(scale=scale, size=weight.shape).astype(dtype)
    return model


def drawn_arguments(rng, model, batch, frames, directions=5):
    """Clips, draws of the prior and directions."""
    dtype = model.weights["state_w"].dtype
    x = rng.normal(size=(batch, frames, model.features)).astype(dtype)
    prior = rng.normal(size=(batch, model.latent)).astype(dtype)
    return x, prior, unit_directions(directions, model.latent, rng, dtype)


def check_whole_loss(model, rng, *material):
    """Compare the gradients of the whole loss with differences, for every weight."""
    names = list(model.weights)

    def loss(*arrays):
        with_arrays = copy(model)
        with_arrays.weights = dict(zip(names, arrays, strict=True))
        value, gradients = with_arrays.loss_and_gradients(*material)
        assert list(gradients) == names
        return np.float64(value.total), lambda up: tuple(up * gradients[name] for name in names)

    start = [model.weights[name].copy() for name in names]
    check_gradients(loss, *start, names=names, rng=rng)


@settings(max_examples=4, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    batch=st.integers(1, 4),
    frames=st.integers(1, 4),
    weight=st.sampled_from([0.0, 0.7]),
    burn_in=st.integers(0, 2),
)
def test_gradients_of_the_whole_loss(seed, batch, frames, weight, burn_in):
    rng = np.random.default_rng(seed)
    model = drawn_model(rng, features=2, hidden=3, burn_in=burn_in)
    material = drawn_arguments(rng, model, batch, frames)
    check_whole_loss(model, rng, *material, weight)


@pytest.mark.parametrize("frames", [1, 4])
def test_the_first_step_is_fed_zeros_and_every_other_its_own_frame(frames):
    rng = np.random.default_rng(7)
    model = drawn_model(rng)
    w = model.weights
    z = rng.normal(size=(3, 2))
    gru = [w[f"decoder_{letter}"] for letter in "wubc"]
    h = z @ w["state_w"] + w["state_b"]
    y = np.zeros((3, 3))
    written = []
    for _ in range(frames):
        h, _ = ops.gru_step(y, h, *gru)
        y = h @ w["frame_w"] + w["frame_b"]
        written.insert(0, y)
    np.testing.assert_allclose(model.decode(z, frames), np.stack(written, axis=1), atol=1e-12)


def test_the_last_frame_of_a_clip_is_written_first_after_the_burn_in():
    """Of ten frames from z, the last five are the five frames from z; a burn-in leaves some out."""
    model = drawn_model(np.random.default_rng(9))
    z = np.random.default_rng(10).normal(size=(2, 2))
    np.testing.assert_allclose(model.decode(z, 10)[:, 5:], model.decode(z, 5), atol=1e-12)
    with_burn_in = copy(model)
    with_burn_in.burn_in = 3
    np.testing.assert_array_equal(with_burn_in.decode(z, 7), model.decode(z, 10)[:, :7])


def test_no_frame_of_the_source_reaches_the_decoder():
    """Two clips with the same z are decoded to the same clip."""
    rng = np.random.default_rng(11)
    model = drawn_model(rng)
    model.weights["encoder_w"][2] = 0  # the encoder ignores the third feature
    x, _, _ = drawn_arguments(rng, model, 2, 6)
    changed = x.copy()
    changed[..., 2] = rng.normal(size=(2, 6))
    np.testing.assert_array_equal(model.encode(changed), model.encode(x))
    np.testing.assert_array_equal(model.denoise(changed), model.denoise(x))


def test_the_loss_compares_frames_in_the_order_of_time_and_adds_the_discrepancy():
    rng = np.random.default_rng(12)
    model = drawn_model(rng)
    x, prior, directions = drawn_arguments(rng, model, 4, 3)
    losses, _ = model.loss_and_gradients(x, prior, directions, 0.25)
    distance, _ = ops.sliced_wasserstein(model.encode(x), prior, directions)
    assert losses.discrepancy == pytest.approx(float(distance), rel=1e-10)
    assert losses.total == pytest.approx(losses.reconstruction + 0.25 * losses.discrepancy)
    assert losses.reconstruction == pytest.approx(np.mean((model.denoise(x) - x) ** 2), rel=1e-10)


def test_initial_weights_are_bounded_by_fan_in_and_fan_out_or_orthogonal():
    weights = SequentialAutoencoder(20, 30, 10, np.random.default_rng(0), np.float64).weights
    for gru in ("encoder", "decoder"):
        for gate in np.split(weights[f"{gru}_u"], 3, axis=1):
            np.testing.assert_allclose(gate.T @ gate, np.eye(30), atol=1e-12)
        np.testing.assert_array_equal(weights[f"{gru}_b"], np.repeat([0.0, 1.0, 0.0], 30))
        assert not weights[f"{gru}_c"].any()
    for name, (fan_in, fan_out) in {
        "encoder_w": (20, 30),
        "decoder_w": (20, 30),
        "latent_w": (30, 10),
        "state_w": (10, 30),
        "frame_w": (30, 20),
    }.items():
        width = np.sqrt(6 / (fan_in + fan_out))
        assert 0.95 * width < np.abs(weights[name]).max() <= width, name


def test_samples_are_clips_of_the_prior():
    model = SequentialAutoencoder(5, 6, 3)
    samples = model.sample(4, np.random.default_rng(1), frames=7)
    assert samples.shape == (4, 7, 5)
    assert samples.dtype == np.float32
    z = np.random.default_rng(1).standard_normal((4, 3)).astype(np.float32)
    np.testing.assert_array_equal(samples, model.decode(z, 7))
    assert np.abs(samples[0] - samples[1]).max() > 0


def loss_of(model, clips, draws):
    return model.loss_and_gradients(np.zeros((clips, 5, 3)), np.zeros((draws, 2)), np.eye(2), 1.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: m.encode(np.zeros((2, 5, 4))), r"x has shape \(2, 5, 4\)"),
        (lambda m: m.encode(np.zeros((2, 0, 3))), "at least one frame"),
        (lambda m: m.decode(np.zeros((2, 3)), 5), r"z has shape \(2, 3\)"),
        (lambda m: m.decode(np.zeros((2, 2)), 0), "frames is 0"),
        (lambda m: loss_of(m, 2, 3), "prior has shape"),
        (lambda m: loss_of(m, 0, 0), r"^x has shape .* nothing to compare"),
    ],
)
def test_arguments_that_do_not_fit_are_errors(call, message):
    with pytest.raises(ValueError, match=message):
        call(SequentialAutoencoder(3, 4, 2, dtype=np.float64))


@pytest.mark.parametrize("frames", [1, 4, 9])
def test_denoised_clips_have_the_frames_that_they_had(frames):
    x = np.random.default_rng(0).normal(size=(2, frames, 5))
    assert SequentialAutoencoder(5, 6, 3).denoise(x).shape == x.shape
