"""The fast network equals the composed one, whatever the sizes and however work is shared."""

import copy
import pickle
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.models import ConvAutoencoder, composed
from numpy_cae.fast.network import FastNetwork, network
from numpy_cae.fast.blas import blas_threads, one_blas_thread
from numpy_cae.fast.team import share, team

TOLERANCE = {np.float64: 1e-10, np.float32: 2e-5}


@pytest.fixture(autouse=True)
def shared_out(monkeypatch):
    """Small networks would use one thread; here they are to use those that they are given."""
    monkeypatch.setattr(network, "WORTH_SHARING", 0)
    monkeypatch.setattr(network, "WINDOWS_FOR_EACH", 1)


def drawn(seed, batch, filters, taps, length, unpooling, dtype=np.float64, features=3):
    """A model with biases, windows, their corruption and masks."""
    rng = np.random.default_rng(seed)
    model = ConvAutoencoder(features, filters, taps, bound=0.9, rng=rng, dtype=dtype)
    for layer in model.layers:
        layer.w = rng.normal(scale=0.3, size=layer.w.shape).astype(dtype)
        layer.b = rng.normal(scale=0.2, size=layer.b.shape).astype(dtype)
    frames = length * model.frames_per_unit
    x = rng.normal(scale=0.5, size=(batch, frames, features)).astype(dtype)
    corrupted = x * (rng.random(x.shape) > 0.1)
    first = None
    if unpooling == "random":
        first = [
            rng.random((batch, frames >> (k + 1), size)) < 0.5 for k, size in enumerate(filters)
        ]
    return model, x, corrupted, first


def assert_same(one, two, tolerance):
    for a, b in zip(one, two, strict=True):
        assert np.shape(a) == np.shape(b)
        assert np.asarray(a).dtype == np.asarray(b).dtype
        atol = tolerance * max(1.0, np.max(np.abs(a), initial=0))
        np.testing.assert_allclose(b, a, rtol=0, atol=atol)


def flat(result):
    loss, gradients = result
    return [loss, *(array for pair in gradients for array in pair)]


SHAPES = {
    "seed": st.integers(0, 2**32 - 1),
    "batch": st.integers(1, 9),
    "filters": st.lists(st.integers(1, 7), min_size=1, max_size=3).map(tuple),
    "taps": st.integers(0, 7).map(lambda half: 2 * half + 1),
    "length": st.integers(1, 21),
    "unpooling": st.sampled_from(["even", "random"]),
}


@settings(max_examples=150, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3), alpha=st.sampled_from([0.0, 0.3]))
def test_loss_and_gradients_equal_the_composed_ones(threads, alpha, **shapes):
    model, x, corrupted, first = drawn(**shapes)
    readable = composed.loss_and_gradients(model.layers, x, corrupted, alpha, first)
    quick = FastNetwork(threads).loss_and_gradients(model.layers, x, corrupted, alpha, first)
    assert_same(flat(readable), flat(quick), 1e-10)


@settings(max_examples=60, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3))
def test_encode_and_decode_equal_the_composed_ones(threads, **shapes):
    model, x, _, _ = drawn(**shapes)
    fast = FastNetwork(threads)
    y = composed.encode(model.layers, x)
    x_hat = composed.decode(model.layers, y)
    assert_same([y], [fast.encode(model.layers, x)], 1e-10)
    assert_same([x_hat], [fast.decode(model.layers, y)], 1e-10)


@pytest.mark.parametrize("batch", [1, 3, 16])
@pytest.mark.parametrize("unpooling", ["even", "random"])
def test_the_papers_network_in_float32(batch, unpooling):
    """As near to float64 as the composed one, both in float32."""
    model, x, corrupted, first = drawn(0, batch, (64, 128, 256), 15, 20, unpooling, features=63)
    for layer in model.layers:  # small enough that arctanh is well conditioned
        layer.w *= 0.05
    exact = flat(composed.loss_and_gradients(model.layers, x, corrupted, 0.01, first))
    for layer in model.layers:
        layer.w, layer.b = layer.w.astype(np.float32), layer.b.astype(np.float32)
    arguments = (x.astype(np.float32), corrupted.astype(np.float32), 0.01, first)
    direct = flat(composed.loss_and_gradients(model.layers, *arguments))
    quick = flat(model.loss_and_gradients(*arguments))
    for truth, a, b in zip(exact, direct, quick, strict=True):
        size = np.abs(truth).max()
        assert np.abs(b - truth).max() < max(1e-5 * size, 4 * np.abs(a - truth).max())


@pytest.mark.parametrize("batch", [1, 9])
@pytest.mark.parametrize("threads", [1, 2])
def test_same_threads_same_bits(batch, threads):
    model, x, corrupted, _ = drawn(0, batch, (16, 32), 15, 40, "even", np.float32)
    results = [
        flat(FastNetwork(threads).loss_and_gradients(model.layers, x, corrupted, 0.01, None))
        for _ in range(5)
    ]
    for result in results[1:]:
        for a, b in zip(results[0], result, strict=True):
            np.testing.assert_array_equal(a, b)


def test_buffers_left_from_other_calls_change_nothing():
    fast = FastNetwork(2)
    model, x, corrupted, first = drawn(0, 9, (4, 3), 5, 8, "random")
    before = flat(fast.loss_and_gradients(model.layers, x, corrupted, 0.1, first))
    for _ in range(3):
        fast.loss_and_gradients(model.layers, 100 * x[::-1], x, 0.1, first)
        fast.encode(model.layers, x[:5])
    after = flat(fast.loss_and_gradients(model.layers, x, corrupted, 0.1, first))
    for a, b in zip(before, after, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("batch", [1, 2, 5])
def test_latent_gradient_is_the_composed_one(batch):
    model, x, _, _ = drawn(batch, batch, (4, 3), 5, 8, "even")
    y = np.random.default_rng(1).uniform(-1.2, 1.2, size=model.encode(x).shape)

    def objective(x_hat):
        gap = x_hat - x
        return float(np.sum(gap**2)), 2 * gap

    expected = composed.latent_gradient(model.layers, y, objective)
    for threads in (1, 2):
        loss, dy = FastNetwork(threads).latent_gradient(model.layers, y, objective)
        assert_same(expected, (loss, dy), 1e-10)


def test_an_objective_that_fails_is_heard():
    model, x, _, _ = drawn(0, 4, (4, 3), 5, 8, "even")

    def objective(x_hat):
        raise KeyError("no such joint")

    fast = FastNetwork(2)
    with pytest.raises(KeyError, match="no such joint"):
        fast.latent_gradient(model.layers, model.encode(x), objective)
    assert_same([composed.encode(model.layers, x)], [fast.encode(model.layers, x)], 1e-10)


def test_results_belong_to_the_caller():
    model, x, corrupted, _ = drawn(0, 9, (4, 3), 5, 8, "even")
    y, x_hat = model.encode(x), model.decode(model.encode(x))
    result = flat(model.loss_and_gradients(x, corrupted))
    kept = [np.array(each) for each in (y, x_hat, *result)]
    model.loss_and_gradients(2 * x, x)
    model.project(3 * x)
    for before, after in zip(kept, (y, x_hat, *result), strict=True):
        np.testing.assert_array_equal(before, after)


def test_more_windows_than_fit_at_once(monkeypatch):
    monkeypatch.setattr(network, "FRAMES_AT_ONCE", 3 * 32)
    model, x, _, _ = drawn(0, 8, (4, 3), 5, 8, "even")
    assert_same([composed.encode(model.layers, x)], [model.encode(x)], 1e-10)
    y = model.encode(x)
    assert_same([composed.decode(model.layers, y)], [model.decode(y)], 1e-10)
    model.layers[0].w[0, 0, 0] += 1  # each call transforms the filters anew, if only once
    assert_same([composed.encode(model.layers, x)], [model.encode(x)], 1e-10)


def test_no_windows_and_no_frames():
    model, *_ = drawn(0, 1, (4, 3), 5, 8, "even")
    assert model.encode(np.zeros((0, 8, 3))).shape == (0, 2, 3)
    assert model.encode(np.zeros((2, 0, 3))).shape == (2, 0, 3)
    assert model.decode(np.zeros((0, 2, 3))).shape == (0, 8, 3)
    with pytest.raises(ValueError, match="nothing to compare"):
        model.loss_and_gradients(np.zeros((0, 8, 3)), np.zeros((0, 8, 3)))


def test_a_change_of_weights_is_seen():
    model, x, _, _ = drawn(0, 1, (4, 3), 5, 8, "even")
    model.encode(x)
    model.layers[0].w[0, 0, 0] += 1
    assert_same([composed.encode(model.layers, x)], [model.encode(x)], 1e-10)


def test_frozen_weights_keep_their_spectra_and_cannot_change_unseen():
    model, x, corrupted, _ = drawn(0, 1, (4, 3), 5, 8, "even")
    expected = composed.encode(model.layers, x)
    model.freeze()
    for _ in range(3):
        assert_same([expected], [model.encode(x)], 1e-10)
    with pytest.raises(ValueError, match="read-only"):
        model.layers[0].w += 1
    model.layers[1].w = 2 * model.layers[1].w
    assert_same([composed.encode(model.layers, x)], [model.encode(x)], 1e-10)
    frozen, fine = model.layers[0].w, model.freeze().encode(x)
    model.layers[0].w = -frozen
    model.loss_and_gradients(x, corrupted)
    model.layers[0].w = frozen
    assert_same([fine], [model.encode(x)], 1e-10)
    model.thaw()
    model.layers[0].w += 1
    assert_same([composed.encode(model.layers, x)], [model.encode(x)], 1e-10)
    fine = composed.loss_and_gradients(model.layers, x, corrupted)
    assert_same(flat(fine), flat(model.loss_and_gradients(x, corrupted)), 1e-10)


def test_models_are_copied_and_pickled():
    model, x, _, _ = drawn(0, 2, (4, 3), 5, 8, "even")
    y = model.encode(x)
    for twin in (copy.deepcopy(model), pickle.loads(pickle.dumps(model))):
        np.testing.assert_array_equal(twin.encode(x), y)


def test_several_callers_at_once():
    model, x, _, _ = drawn(0, 9, (4, 3), 5, 8, "even")
    inputs = [x * scale for scale in (0.5, 1, 2, 3)]
    expected = [model.encode(each) for each in inputs]
    results = [None] * len(inputs)

    def work(k):
        for _ in range(20):
            results[k] = model.encode(inputs[k])
            np.testing.assert_array_equal(results[k], expected[k])

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(inputs))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for a, b in zip(expected, results, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_member_that_fails_frees_the_others_and_says_why():
    def work(member):
        if member == 1:
            raise KeyError("what went wrong")
        team(2).wait(member)

    for _ in range(2):
        with pytest.raises(KeyError, match="what went wrong"):
            team(2).run(work)
    done = []
    team(2).run(done.append)
    assert sorted(done) == [0, 1]


def test_the_number_of_blas_threads_comes_back():
    before = blas_threads()
    if before is None:
        pytest.skip("this NumPy does not bring its own OpenBLAS")
    with one_blas_thread():
        assert blas_threads() == 1
    assert blas_threads() == before


def test_shares_cover_everything_once():
    parts = [share(11, member, 3) for member in range(3)]
    assert [n for part in parts for n in range(11)[part]] == list(range(11))
