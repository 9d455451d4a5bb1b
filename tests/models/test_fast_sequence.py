"""The fast sequential autoencoder equals the composed one, however its clips are shared out."""

import copy
import pickle
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.models import SequentialAutoencoder, composed_sequence
from numpy_cae.fast.sequence_network import FastSequence, network
from numpy_cae.training import unit_directions
from numpy_cae.verify import check_gradients

TOLERANCE = {np.float64: 1e-10, np.float32: 2e-5}


@pytest.fixture(autouse=True)
def shared_out(monkeypatch):
    """Small networks would use one thread; here they are to use those that they are given."""
    monkeypatch.setattr(network, "UNITS_FOR_A_CLIP", 1000)
    monkeypatch.setattr(network, "NUMBERS_FOR_EACH", 1)


def drawn(seed, batch, frames, features=3, hidden=4, latent=2, dtype=np.float64):
    """Weights whose biases are not zero, clips, draws of the prior and directions."""
    rng = np.random.default_rng(seed)
    weights = SequentialAutoencoder(features, hidden, latent, rng, dtype).weights
    for name, weight in weights.items():
        weights[name] = rng.normal(scale=0.5, size=weight.shape).astype(dtype)
    x = rng.normal(size=(batch, frames, features)).astype(dtype)
    prior = rng.normal(size=(batch, latent)).astype(dtype)
    return weights, x, prior, unit_directions(5, latent, rng, dtype)


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
}


@settings(max_examples=80, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3), weight=st.sampled_from([0.0, 0.3]))
def test_loss_and_gradients_equal_the_composed_ones(threads, weight, **shapes):
    material = drawn(**shapes)
    readable = composed_sequence.loss_and_gradients(*material, weight)
    fast = FastSequence(threads)
    assert_same(readable, fast.loss_and_gradients(*material, weight), TOLERANCE[shapes["dtype"]])


@settings(max_examples=40, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3), written=st.integers(1, 9))
def test_encode_and_decode_equal_the_composed_ones(threads, written, **shapes):
    weights, x, prior, _ = drawn(**shapes)
    fast, tolerance = FastSequence(threads), TOLERANCE[shapes["dtype"]]
    z, _ = composed_sequence.encode(weights, x)
    np.testing.assert_allclose(fast.encode(weights, x), z, atol=5 * tolerance)
    clips, _ = composed_sequence.decode(weights, prior, written)
    quick = fast.decode(weights, prior, written)
    np.testing.assert_allclose(quick, clips, atol=tolerance * max(1, np.abs(clips).max()))
    assert quick.dtype == clips.dtype


def test_the_papers_sizes_in_float32():
    """50 frames of 54 values, through states that have been fed back fifty times."""
    weights, x, prior, directions = drawn(1, 16, 50, 54, 24, 8, np.float32)
    for name in weights:
        weights[name] *= 0.3
    readable = composed_sequence.loss_and_gradients(weights, x, prior, directions, 0.1)
    quick = FastSequence().loss_and_gradients(weights, x, prior, directions, 0.1)
    assert_same(readable, quick, TOLERANCE[np.float32])


def test_gradients_of_the_whole_loss_by_differences():
    """Not by way of the composed form: the fast one against differences itself."""
    rng = np.random.default_rng(2)
    weights, x, prior, directions = drawn(2, 3, 3, hidden=3)
    fast, names = FastSequence(2), list(weights)

    def loss(*arrays):
        given = dict(zip(names, arrays, strict=True))
        value, gradients = fast.loss_and_gradients(given, x, prior, directions, 0.4)
        return np.float64(value.total), lambda up: tuple(up * gradients[name] for name in names)

    check_gradients(loss, *(weights[name] for name in names), names=names, rng=rng)


def test_buffers_hold_nothing_over():
    """Other sizes and other weights in between change nothing, and what was returned stays."""
    one, other = drawn(3, 4, 5), drawn(4, 4, 5)
    fast = FastSequence(2)
    first = fast.loss_and_gradients(*one, 0.3)
    kept = {name: gradient.copy() for name, gradient in first[1].items()}
    fast.loss_and_gradients(*other, 0.3)
    fast.loss_and_gradients(*drawn(5, 3, 2), 0.3)
    assert_same(first, (first[0], kept), 0)
    again = fast.loss_and_gradients(*one, 0.3)
    assert again[0] == first[0]
    for name, gradient in kept.items():
        np.testing.assert_array_equal(again[1][name], gradient)


def test_nothing_given_is_altered():
    weights, x, prior, directions = drawn(6, 4, 5)
    copies = copy.deepcopy((weights, x, prior, directions))
    FastSequence(2).loss_and_gradients(weights, x, prior, directions, 0.3)
    for one, two in zip((x, prior, directions), copies[1:], strict=True):
        np.testing.assert_array_equal(one, two)
    for name, weight in weights.items():
        np.testing.assert_array_equal(weight, copies[0][name])


def test_many_clips_go_in_parts(monkeypatch):
    weights, x, _, _ = drawn(7, 11, 4)
    whole = FastSequence(1)
    z = whole.encode(weights, x)
    clips = whole.decode(weights, z, 4)
    monkeypatch.setattr(network, "CLIPS_AT_ONCE", 4)
    parts = FastSequence(2)
    np.testing.assert_allclose(parts.encode(weights, x), z, atol=1e-12)
    np.testing.assert_allclose(parts.decode(weights, z, 4), clips, atol=1e-12)
    assert parts.decode(weights, z[:0], 4).shape == (0, 4, 3)
    assert parts.encode(weights, x[:0]).shape == (0, 2)


def test_any_strides_will_do():
    weights, x, prior, directions = drawn(8, 4, 6)
    turned = np.asfortranarray(x[:, ::-1])[:, ::-1]
    fast = FastSequence(1)
    straight = fast.loss_and_gradients(weights, x, prior, directions, 0.3)
    assert_same(straight, fast.loss_and_gradients(weights, turned, prior, directions, 0.3), 1e-12)


def test_a_model_can_be_copied_and_pickled():
    model = SequentialAutoencoder(3, 5, 2)
    x = np.random.default_rng(0).normal(size=(2, 4, 3)).astype(np.float32)
    z = model.encode(x)
    for other in (copy.deepcopy(model), pickle.loads(pickle.dumps(model))):
        np.testing.assert_array_equal(other.encode(x), z)


def test_two_callers_take_turns():
    material = drawn(9, 6, 8, hidden=9)
    fast, results = FastSequence(2), []
    expected = composed_sequence.loss_and_gradients(*material, 0.3)
    callers = [
        threading.Thread(target=lambda: results.append(fast.loss_and_gradients(*material, 0.3)))
        for _ in range(4)
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert len(results) == 4
    for result in results:
        assert_same(expected, result, 1e-10)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_the_same_threads_give_the_same_bits(threads):
    material = drawn(10, 7, 5, hidden=8, dtype=np.float32)
    one, two = (FastSequence(threads).loss_and_gradients(*material, 0.3) for _ in range(2))
    assert one[0] == two[0]
    for name, gradient in one[1].items():
        np.testing.assert_array_equal(gradient, two[1][name])
