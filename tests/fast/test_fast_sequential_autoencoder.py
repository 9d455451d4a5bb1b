"""The fast sequential autoencoder equals its definition, with any sizes and number of threads."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.fast import FastSequentialAutoencoder, accelerate, fast_sequential_autoencoder
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import unit_directions

TOLERANCE = {np.float64: 1e-10, np.float32: 2e-5}


@pytest.fixture(autouse=True)
def always_use_threads(monkeypatch):
    """Small networks would use one thread; here they use as many as they are given."""
    monkeypatch.setattr(fast_sequential_autoencoder, "MIN_STATES_PER_THREAD", 1)


def drawn(seed, batch, frames, features=3, hidden=4, latent=2, dtype=np.float64, burn_in=0):
    """A model whose biases are not zero, clips, draws of the prior and directions."""
    rng = np.random.default_rng(seed)
    model = SequentialAutoencoder(features, hidden, latent, rng, dtype, burn_in)
    weights = model.weights
    for name, weight in weights.items():
        weights[name] = rng.normal(scale=0.5, size=weight.shape).astype(dtype)
    x = rng.normal(size=(batch, frames, features)).astype(dtype)
    prior = rng.normal(size=(batch, latent)).astype(dtype)
    return model, x, prior, unit_directions(5, latent, rng, dtype)


def assert_same(one, two, tolerance):
    losses, gradients = one
    other_losses, other_gradients = two
    np.testing.assert_allclose(other_losses, losses, rtol=tolerance)
    assert list(gradients) == list(other_gradients)
    for name, gradient in gradients.items():
        assert other_gradients[name].shape == gradient.shape
        assert other_gradients[name].dtype == gradient.dtype
        atol = tolerance * max(1.0, np.abs(gradient).max())
        np.testing.assert_allclose(other_gradients[name], gradient, rtol=0, atol=atol)


SHAPES = {
    "seed": st.integers(0, 2**32 - 1),
    "batch": st.integers(1, 7),
    "frames": st.integers(1, 7),
    "features": st.integers(1, 5),
    "hidden": st.integers(1, 18),
    "latent": st.integers(1, 4),
    "dtype": st.sampled_from([np.float64, np.float32]),
    "burn_in": st.integers(0, 3),
}


@settings(max_examples=60, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3), weight=st.sampled_from([0.0, 0.3]))
def test_loss_and_gradients_equal_the_definition(threads, weight, **shapes):
    model, *material = drawn(**shapes)
    expected = model.loss_and_gradients(*material, weight)
    found = accelerate(model, threads).loss_and_gradients(*material, weight)
    assert_same(expected, found, TOLERANCE[shapes["dtype"]])


@settings(max_examples=30, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3), written=st.integers(1, 9))
def test_encode_and_decode_equal_the_definition(threads, written, **shapes):
    model, x, prior, _ = drawn(**shapes)
    fast, tolerance = accelerate(model, threads), TOLERANCE[shapes["dtype"]]
    np.testing.assert_allclose(fast.encode(x), model.encode(x), atol=5 * tolerance)
    assert fast.encode(x).dtype == shapes["dtype"]
    clips, found = model.decode(prior, written), fast.decode(prior, written)
    np.testing.assert_allclose(found, clips, atol=tolerance * max(1, np.abs(clips).max()))
    assert found.dtype == clips.dtype


def test_the_papers_sizes_in_float32():
    """50 frames of 54 values, through states that have been fed back fifty times."""
    model, *material = drawn(1, 16, 50, 54, 24, 8, np.float32)
    for name in model.weights:
        model.weights[name] *= 0.3
    expected = model.loss_and_gradients(*material, 0.1)
    assert_same(expected, accelerate(model).loss_and_gradients(*material, 0.1), 2e-5)


def test_results_do_not_depend_on_earlier_calls_and_are_not_overwritten():
    model, *material = drawn(3, 4, 5)
    fast = accelerate(model, 2)
    first = fast.loss_and_gradients(*material, 0.3)
    kept = {name: gradient.copy() for name, gradient in first[1].items()}
    fast.loss_and_gradients(*drawn(4, 4, 5)[1:], 0.3)
    fast.loss_and_gradients(*drawn(5, 3, 2)[1:], 0.3)
    assert_same(first, (first[0], kept), 0)
    again = fast.loss_and_gradients(*material, 0.3)
    assert again[0] == first[0]
    for name, gradient in kept.items():
        np.testing.assert_array_equal(again[1][name], gradient)


def test_arguments_are_not_altered_and_may_have_any_strides():
    model, x, prior, directions = drawn(6, 4, 6)
    copies = copy.deepcopy((model.weights, x, prior, directions))
    fast = accelerate(model, 2)
    expected = fast.loss_and_gradients(x, prior, directions, 0.3)
    strided = np.asfortranarray(x[:, ::-1])[:, ::-1]
    assert_same(expected, fast.loss_and_gradients(strided, prior, directions, 0.3), 1e-12)
    for one, two in zip((x, prior, directions), copies[1:], strict=True):
        np.testing.assert_array_equal(one, two)
    for name, weight in model.weights.items():
        np.testing.assert_array_equal(weight, copies[0][name])


def test_a_change_of_weights_is_seen():
    model, x, prior, _ = drawn(7, 3, 4)
    fast = accelerate(model)
    for _ in range(2):
        np.testing.assert_allclose(fast.encode(x), model.encode(x), atol=1e-12)
        np.testing.assert_allclose(fast.decode(prior, 3), model.decode(prior, 3), atol=1e-12)
        model.weights["encoder_u"][0, 0] += 0.5
        model.weights["decoder_w"] = -model.weights["decoder_w"]
        fast.weights["frame_b"] = fast.weights["frame_b"] + 1


def test_many_clips_go_in_parts(monkeypatch):
    model, x, _, _ = drawn(7, 11, 4)
    z = model.encode(x)
    monkeypatch.setattr(fast_sequential_autoencoder, "MAX_CLIPS", 4)
    fast = accelerate(model, 2)
    np.testing.assert_allclose(fast.encode(x), z, atol=1e-12)
    np.testing.assert_allclose(fast.decode(z, 4), model.decode(z, 4), atol=1e-12)
    assert fast.decode(z[:0], 4).shape == (0, 4, 3)
    assert fast.encode(x[:0]).shape == (0, 2)


def test_the_accelerated_model_shares_weights_and_can_be_copied_and_pickled():
    model = SequentialAutoencoder(3, 5, 2)
    fast = accelerate(model)
    assert isinstance(fast, FastSequentialAutoencoder)
    assert accelerate(fast) is fast
    assert fast.weights is model.weights
    assert (fast.features, fast.hidden, fast.latent) == (3, 5, 2)
    x = np.random.default_rng(0).normal(size=(2, 4, 3)).astype(np.float32)
    z = fast.encode(x)
    for twin in (copy.deepcopy(fast), pickle.loads(pickle.dumps(fast))):
        np.testing.assert_array_equal(twin.encode(x), z)
        assert twin.weights["state_w"] is not model.weights["state_w"]


def test_a_subclass_with_its_own_loss_is_not_replaced():
    class Other(SequentialAutoencoder):
        """A subclass."""

    other = Other(3, 5, 2)
    assert accelerate(other) is other


def test_several_callers_at_once():
    model, *material = drawn(9, 6, 8, hidden=9)
    fast = accelerate(model, 2)
    expected = model.loss_and_gradients(*material, 0.3)
    with ThreadPoolExecutor(4) as pool:
        calls = [pool.submit(fast.loss_and_gradients, *material, 0.3) for _ in range(8)]
        for call in calls:
            assert_same(expected, call.result(), 1e-10)
