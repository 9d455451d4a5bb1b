"""The fast convolutional autoencoder equals its definition, with any number of threads."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.fast import FastConvAutoencoder, accelerate, fast_conv_autoencoder
from numpy_cae.models import ConvAutoencoder


@pytest.fixture(autouse=True)
def always_use_threads(monkeypatch):
    """Small networks would use one thread; here they use as many as they are given."""
    monkeypatch.setattr(fast_conv_autoencoder, "MIN_MULTIPLICATIONS", 0)


def drawn(seed, batch, filters, taps, length, unpooling, dtype=np.float64, features=3):
    """A model with biases, windows, their corruption and masks."""
    rng = np.random.default_rng(seed)
    model = ConvAutoencoder(features, filters, taps, bound=0.9, rng=rng, dtype=dtype)
    for layer in model.layers:
        layer.w = rng.normal(scale=0.3, size=layer.w.shape).astype(dtype)
        layer.b = rng.normal(scale=0.2, size=layer.b.shape).astype(dtype)
    frames = length * model.stride
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


@settings(max_examples=60, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3), alpha=st.sampled_from([0.0, 0.3]))
def test_loss_and_gradients_equal_the_definition(threads, alpha, **shapes):
    model, x, corrupted, first = drawn(**shapes)
    expected = model.loss_and_gradients(x, corrupted, alpha, first)
    found = accelerate(model, threads).loss_and_gradients(x, corrupted, alpha, first)
    assert_same(flat(expected), flat(found), 1e-10)


@settings(max_examples=40, deadline=None)
@given(**SHAPES, threads=st.integers(1, 3))
def test_encode_decode_and_pullback_equal_the_definition(threads, **shapes):
    model, x, _, _ = drawn(**shapes)
    fast = accelerate(model, threads)
    y = model.encode(x)
    assert_same([y], [fast.encode(x)], 1e-10)
    y = 1.5 * y  # beyond the bound of arctanh as well
    x_hat, pullback = model.decode_with_pullback(y)
    fast_x_hat, fast_pullback = fast.decode_with_pullback(y)
    assert_same([x_hat, x_hat], [fast.decode(y), fast_x_hat], 1e-10)
    assert_same([pullback(x), pullback(x_hat)], [fast_pullback(x), fast_pullback(x_hat)], 1e-10)


@pytest.mark.parametrize(("batch", "unpooling"), [(1, "even"), (5, "random")])
def test_the_papers_network_in_float32(batch, unpooling):
    """In float32, as near to float64 as the definition in float32."""
    model, x, corrupted, first = drawn(0, batch, (64, 128, 256), 15, 20, unpooling, features=63)
    for layer in model.layers:  # small enough that arctanh is well conditioned
        layer.w *= 0.05
    exact = flat(model.loss_and_gradients(x, corrupted, 0.01, first))
    for layer in model.layers:
        layer.w, layer.b = layer.w.astype(np.float32), layer.b.astype(np.float32)
    arguments = (x.astype(np.float32), corrupted.astype(np.float32), 0.01, first)
    direct = flat(model.loss_and_gradients(*arguments))
    fast = accelerate(model)
    y, x_hat = fast.encode(arguments[0]), fast.project(arguments[0])
    decoded, pullback = fast.decode_with_pullback(y)
    for each in (y, x_hat, decoded, fast.decode(y), pullback(decoded)):
        assert each.dtype == np.float32
    quick = flat(fast.loss_and_gradients(*arguments))
    for truth, a, b in zip(exact, direct, quick, strict=True):
        assert np.ndim(b) == 0 or b.dtype == np.float32
        size = np.abs(truth).max()
        assert np.abs(b - truth).max() < max(1e-5 * size, 4 * np.abs(a - truth).max())


def test_results_do_not_depend_on_earlier_calls_and_are_not_overwritten():
    model, x, corrupted, first = drawn(0, 9, (4, 3), 5, 8, "random")
    fast = accelerate(model, 2)
    arguments = (x, corrupted, 0.1, first)
    before = [fast.encode(x), fast.project(x), *flat(fast.loss_and_gradients(*arguments))]
    kept = [np.array(each) for each in before]
    for _ in range(3):
        fast.loss_and_gradients(100 * x[::-1], x, 0.1, first)
        fast.encode(x[:5])
        fast.project(3 * x)
    after = [fast.encode(x), fast.project(x), *flat(fast.loss_and_gradients(*arguments))]
    for results in (before, after):
        for expected, found in zip(kept, results, strict=True):
            np.testing.assert_array_equal(expected, found)


@pytest.mark.parametrize("batch", [1, 4])
def test_a_pullback_is_valid_after_other_calls(batch):
    model, x, _, _ = drawn(1, batch, (4, 3), 5, 8, "even")
    fast = accelerate(model, 2)
    ys = [scale * model.encode(x) for scale in (1.0, 0.5, -1.2)]
    pullbacks = [fast.decode_with_pullback(y)[1] for y in ys]
    fast.encode(x)
    given_y = ys[0].copy()
    for k in (2, 0, 1, 1, 2):
        expected = model.decode_with_pullback(ys[k])[1](x)
        assert_same([expected], [pullbacks[k](x)], 1e-10)
        fast.encode(2 * x)
    np.testing.assert_array_equal(ys[0], given_y)
    ys[0][...] = 0  # the caller may use its array again
    assert_same([model.decode_with_pullback(given_y)[1](x)], [pullbacks[0](x)], 1e-10)


def test_no_windows_and_no_frames():
    model, *_ = drawn(0, 1, (4, 3), 5, 8, "even")
    for each in (model, accelerate(model)):
        assert each.encode(np.zeros((0, 8, 3))).shape == (0, 2, 3)
        assert each.encode(np.zeros((2, 0, 3))).shape == (2, 0, 3)
        assert each.decode(np.zeros((0, 2, 3))).shape == (0, 8, 3)
        x_hat, pullback = each.decode_with_pullback(np.zeros((0, 2, 3)))
        assert pullback(x_hat).shape == (0, 2, 3)
        with pytest.raises(ValueError, match="nothing to compare"):
            each.loss_and_gradients(np.zeros((0, 8, 3)), np.zeros((0, 8, 3)))


def change_one_weight(layer):
    layer.w[-1, -1, -1] += 1e-3


def assign_another_array(layer):
    layer.w = np.asfortranarray(-1.1 * layer.w)


def change_through_a_view(layer):
    layer.w[::-1][:, 0] *= 2
    layer.b += 1


def change_the_dtype(layer):
    layer.w, layer.b = layer.w.astype(np.float32), layer.b.astype(np.float32)


@pytest.mark.parametrize(
    "change", [change_one_weight, assign_another_array, change_through_a_view, change_the_dtype]
)
@pytest.mark.parametrize(("batch", "changed"), [(1, [0]), (5, [1]), (1, [0, 1])])
def test_any_change_of_weights_between_calls_is_seen(monkeypatch, change, batch, changed):
    monkeypatch.setattr(fast_conv_autoencoder, "MAX_FRAMES", 3 * 32)  # batches of 5 in two parts
    model, x, corrupted, _ = drawn(0, batch, (4, 3), 5, 8, "even")
    fast = accelerate(model, 2)
    y = model.encode(x)
    original = [(layer.w, layer.b) for layer in model.layers]
    for step in range(3):
        tolerance = 1e-5 if step == 2 and change is change_the_dtype else 1e-10
        assert_same([model.encode(x)], [fast.encode(x)], tolerance)
        assert_same([model.decode(y)], [fast.decode(y)], tolerance)
        if step == 1:
            fast.loss_and_gradients(x, corrupted)
            for number, layer in enumerate(model.layers):
                if number in changed or change is change_the_dtype:
                    change(layer)
    for layer, (w, b) in zip(model.layers, original, strict=True):
        layer.w, layer.b = w, b  # back to the arrays of an earlier call
    assert_same([model.encode(x)], [fast.encode(x)], 1e-10)
    gradients = model.loss_and_gradients(x, corrupted)
    assert_same(flat(gradients), flat(fast.loss_and_gradients(x, corrupted)), 1e-10)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("batch", [1, 5])
def test_weights_that_were_infinite_cause_no_later_warning(batch):
    model, x, _, _ = drawn(0, batch, (4, 3), 5, 8, "even")
    fast, w = accelerate(model, 2), model.layers[0].w
    model.layers[0].w = np.full_like(w, np.inf)
    with np.errstate(all="ignore"):
        fast.encode(x)
    model.layers[0].w = w
    assert_same([model.encode(x)], [fast.encode(x)], 1e-10)


def test_the_accelerated_model_shares_layers_and_attributes():
    model, x, _, _ = drawn(0, 1, (4, 3), 5, 8, "even")
    fast = accelerate(model)
    assert isinstance(fast, FastConvAutoencoder)
    assert accelerate(fast) is fast
    assert fast.layers is model.layers
    assert fast.stride == model.stride == 4
    for name, array in model.parameters.items():
        assert fast.parameters[name] is array
    assert_same([model.project(x)], [fast.project(x)], 1e-10)


def test_arguments_are_checked():
    fast = accelerate(drawn(0, 1, (4, 3), 5, 8, "even")[0])
    with pytest.raises(ValueError, match="expected a multiple of 4 frames"):
        fast.encode(np.zeros((1, 6, 3)))
    with pytest.raises(ValueError, match="y has shape"):
        fast.decode(np.zeros((1, 6, 4)))
    with pytest.raises(ValueError, match="y has shape"):
        fast.decode_with_pullback(np.zeros((1, 6, 4)))
    with pytest.raises(ValueError, match="dx_hat has shape"):
        fast.decode_with_pullback(np.zeros((1, 6, 3)))[1](np.zeros((1, 6, 3)))
    with pytest.raises(ValueError, match="corrupted has shape"):
        fast.loss_and_gradients(np.zeros((1, 8, 3)), np.zeros((2, 8, 3)))


def test_models_are_copied_and_pickled():
    model, x, _, _ = drawn(0, 2, (4, 3), 5, 8, "even")
    fast = accelerate(model)
    y = fast.encode(x)
    for twin in (copy.deepcopy(fast), pickle.loads(pickle.dumps(fast))):
        np.testing.assert_array_equal(twin.encode(x), y)
        twin.layers[0].w *= 2
        np.testing.assert_array_equal(fast.encode(x), y)
        assert np.abs(twin.encode(x) - y).max() > 1e-3
    both = copy.deepcopy({"model": model, "fast": fast})
    assert both["fast"].layers is both["model"].layers


def test_several_callers_at_once():
    model, x, _, _ = drawn(0, 9, (4, 3), 5, 8, "even")
    fast, inputs = accelerate(model), [x * scale for scale in (0.5, 1, 2, 3)]
    expected = [fast.encode(each) for each in inputs]
    with ThreadPoolExecutor(4) as pool:
        for k, found in enumerate(pool.map(fast.encode, inputs * 20)):
            np.testing.assert_array_equal(found, expected[k % 4])
