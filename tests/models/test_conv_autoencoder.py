"""The whole loss of holden2015, equation 3, through the models' own `loss_and_gradients`."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae import ops
from numpy_cae.models import ConvAutoencoder
from numpy_cae.verify import check_gradients

FILTERS = (4, 3, 5)


def drawn_model(rng, features=3, filters=FILTERS, taps=3):
    """A small float64 network with biases that are not zero."""
    model = ConvAutoencoder(features, filters, taps, bound=0.9, rng=rng, dtype=np.float64)
    for layer in model.layers:
        layer.w = rng.normal(scale=0.4, size=layer.w.shape)
        layer.b = rng.normal(scale=0.2, size=layer.b.shape)
    return model


MODEL = drawn_model(np.random.default_rng(0), filters=(4, 5))
X, CORRUPTED = np.random.default_rng(1).normal(scale=0.3, size=(2, 2, 8, 3))


def masks_for(layers, batch, frames, rng):
    return [
        rng.random((batch, frames // 2 ** (k + 1), len(layer.b))) < 0.5
        for k, layer in enumerate(layers)
    ]


def as_function_of_parameters(model, x, corrupted, alpha, first, layer):
    """The loss as an operation on all weights and biases, for `check_gradients`."""
    layers = model.layers if layer is None else [model.layers[layer]]

    def loss(*parameters):
        for used, w, b in zip(layers, parameters[0::2], parameters[1::2], strict=True):
            used.w = w
            used.b = b
        value, gradients = model.loss_and_gradients(x, corrupted, alpha, first, layer)
        flat = [gradient for pair in gradients for gradient in pair]
        return np.float64(value), lambda dloss: tuple(dloss * gradient for gradient in flat)

    start = []
    names = []
    for number, used in enumerate(layers, start=1):
        start += [used.w.copy(), used.b.copy()]
        names += [f"w{number}", f"b{number}"]
    return loss, start, names


@settings(max_examples=6)
@given(
    seed=st.integers(0, 2**32 - 1),
    random_unpooling=st.booleans(),
    alpha=st.floats(0, 0.5),
    layer=st.sampled_from([None, 0, 1, 2]),
)
def test_gradients_of_the_stack_and_of_one_layer(seed, random_unpooling, alpha, layer):
    rng = np.random.default_rng(seed)
    model = drawn_model(rng)
    used = model.layers if layer is None else [model.layers[layer]]
    x = rng.normal(scale=0.5, size=(2, 16, used[0].w.shape[1]))
    corrupted = x * (rng.random(x.shape) > 0.1)
    first = masks_for(used, 2, 16, rng) if random_unpooling else None
    loss, start, names = as_function_of_parameters(model, x, corrupted, alpha, first, layer)
    check_gradients(loss, *start, names=names, rng=rng)


def test_a_layer_encodes_by_equation_1_and_decodes_by_equation_2():
    rng = np.random.default_rng(3)
    layer = drawn_model(rng, filters=(4,)).layers[0]
    x = rng.normal(size=(2, 8, 3))
    y, _ = layer.encode_with_pullback(x)
    convolved = ops.conv1d(x, layer.w, layer.b)[0]
    np.testing.assert_allclose(y, np.tanh(np.maximum(convolved[:, ::2], convolved[:, 1::2])))

    decoded, _ = layer.decode_with_pullback(y)
    activated = np.arctanh(np.clip(y, -layer.bound, layer.bound))
    inside = np.repeat(activated / 2, 2, axis=1) - layer.b
    w_tilde = ops.transpose_filters(layer.w)[0]
    np.testing.assert_allclose(decoded, ops.conv1d(inside, w_tilde, np.zeros(3))[0])


@settings(max_examples=6)
@given(seed=st.integers(0, 2**32 - 1), random_unpooling=st.booleans())
def test_gradients_of_a_layers_input_and_parameters(seed, random_unpooling):
    rng = np.random.default_rng(seed)
    layer = drawn_model(rng, filters=(4,)).layers[0]
    y = rng.uniform(-1.1, 1.1, size=(2, 3, 4))
    first = rng.random(y.shape) < 0.5 if random_unpooling else None

    def decode(y, w, b):
        layer.w, layer.b = w, b
        return layer.decode_with_pullback(y, first)

    def encode(x, w, b):
        layer.w, layer.b = w, b
        return layer.encode_with_pullback(x)

    w, b = layer.w.copy(), layer.b.copy()
    check_gradients(decode, y, w, b, rng=rng)
    check_gradients(encode, rng.normal(size=(2, 6, 3)), w, b, rng=rng)


def test_default_shapes_are_the_papers():
    model = ConvAutoencoder()
    shapes = [layer.w.shape for layer in model.layers]
    assert shapes == [(15, 63, 64), (15, 64, 128), (15, 128, 256)]
    x = np.random.default_rng(0).normal(size=(2, 160, 63)).astype(np.float32)
    y = model.encode(x)
    assert y.shape == (2, 20, 256)
    assert y.dtype == np.float32 and ConvAutoencoder(dtype=float).layers[0].w.dtype == float
    assert model.project(x).shape == x.shape
    np.testing.assert_array_equal(model.project(x), model.decode(y))
    _, gradients = model.loss_and_gradients(x, x, 0.1)
    assert {g.dtype for pair in gradients for g in pair} == {np.dtype(np.float32)}


def test_initial_filters_are_bounded_by_fan_in_and_fan_out_and_biases_are_zero():
    model = ConvAutoencoder(rng=np.random.default_rng(1))
    for layer in model.layers:
        taps, channels, filters = layer.w.shape
        width = np.sqrt(6 / (taps * (channels + filters)))
        assert np.abs(layer.w).max() <= width
        assert layer.w.std() == pytest.approx(width / np.sqrt(3), rel=0.02)
        assert not layer.b.any()


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ((2, 16, 4), r"\(2, 16, 4\)"),
        ((2, 12, 3), "an even number .* a multiple of 8 frames"),
        ((16, 3), r"\(16, 3\)"),
    ],
)
def test_a_window_of_a_wrong_shape_is_an_error(shape, message):
    with pytest.raises(ValueError, match=f"x has shape.*{message}"):
        drawn_model(np.random.default_rng(0)).encode(np.zeros(shape))


@pytest.mark.parametrize(
    ("masks", "message"),
    [
        ([np.ones((2, 4, 4), bool)], "first has 1 masks, expected 2, one for a layer"),
        ([None, np.ones((2, 2, 4), bool)], r"first\[1\] has shape .* expected \(2, 2, 5\)"),
        ([None, np.ones((2, 2, 5), np.int8)], r"first\[1\] has dtype int8, expected bool"),
    ],
)
def test_masks_that_do_not_fit_are_errors(masks, message):
    with pytest.raises(ValueError, match=message):
        MODEL.loss_and_gradients(X, CORRUPTED, first=masks)


@pytest.mark.parametrize("options", [{}, {"alpha": 0.3}, {"alpha": 0.3, "first": [None, None]}])
def test_the_loss_is_equation_3(options):
    loss, _ = MODEL.loss_and_gradients(X, CORRUPTED, **options)
    y = MODEL.encode(CORRUPTED)
    sparsity = options.get("alpha", 0.0) * np.mean(np.abs(y))
    expected = np.mean((MODEL.decode(y) - X) ** 2) + sparsity
    assert loss == pytest.approx(expected, rel=1e-12)


def test_each_mask_is_used_by_its_own_layer():
    masks = masks_for(MODEL.layers, 2, 8, np.random.default_rng(5))
    loss, _ = MODEL.loss_and_gradients(X, CORRUPTED, first=masks)
    lower, upper = MODEL.layers
    below = upper.decode_with_pullback(MODEL.encode(CORRUPTED), masks[1])[0]
    x_hat = lower.decode_with_pullback(below, masks[0])[0]
    assert loss == pytest.approx(np.mean((x_hat - X) ** 2), rel=1e-12)
    evenly, _ = MODEL.loss_and_gradients(X, CORRUPTED)
    assert abs(loss - evenly) > 1e-3


@settings(max_examples=5)
@given(seed=st.integers(0, 2**32 - 1))
def test_gradient_for_the_hidden_units(seed):
    rng = np.random.default_rng(seed)
    model = drawn_model(rng)
    y = rng.uniform(-0.2, 0.2, size=(2, 3, FILTERS[-1]))  # far from where arctanh clips
    upstream = rng.normal(size=(2, 24, 3))

    def decoded(y):
        x_hat, pullback = model.decode_with_pullback(y)
        value = np.sum(upstream * x_hat**2)
        return np.float64(value), lambda d: d * pullback(2 * upstream * x_hat)

    check_gradients(decoded, y, names=["y"], rng=rng)


def test_passing_weights_return_slow_motion_before_any_training():
    x = 0.1 * np.sin(np.arange(160)[:, None] / np.linspace(15, 30, 9) + np.arange(9))[None]
    model = ConvAutoencoder(9, (9, 18, 36), 15, initial="passing")
    assert {array.dtype for array in model.parameters.values()} == {np.dtype(np.float32)}
    assert np.abs(model.project(x) - x)[:, 40:-40].mean() < 0.2 * np.abs(x).mean()
    for taps, slopes in ((1, 0), (2, 9), (15, 9)):  # of a slope, the middle tap is 0
        w = ConvAutoencoder(9, (18,), taps, initial="passing").layers[0].w
        assert np.all(w[taps // 2] == 0, axis=0).sum() == slopes
    size = np.linalg.norm(w[..., :9], axis=(1, 2))
    np.testing.assert_allclose(
        size / size.max(), np.exp(-((np.arange(15) - 7) ** 2) / 2), atol=1e-6
    )
